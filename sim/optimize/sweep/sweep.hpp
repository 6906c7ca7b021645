#pragma once

// A sweep: runs of one scenario with all combinations of some values.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/measure/measure.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/evaluation/workers.hpp"
#include "sim/optimize/experiment/search_space.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

inline constexpr std::uint64_t max_sweep_runs = 100'000;

struct SweptQuantity {
  enum class Kind : std::uint8_t { parameter, seed, friction, x, y, heading };
  Kind kind = Kind::parameter;
  std::string name;  ///< name of a parameter as in `--set`; or of another kind: "x" of the start position
  std::vector<std::string> values;  ///< decimal numbers, ascending, at least one
  std::string unit;                 ///< "" if dimensionless
  std::string argument;             ///< text of `--over`
};

struct Sweep {
  sim::Scenario scenario;
  std::vector<SweptQuantity> quantities;  ///< at least one, no name twice
  std::vector<std::string> settings;      ///< the arguments of `--set`, which the scenario has

  /// Number of combinations; 1 to max_sweep_runs.
  [[nodiscard]] std::uint64_t size() const;
  /// Indices of the values of a combination. The last quantity varies fastest.
  [[nodiscard]] Candidate combination(std::uint64_t number) const;
  [[nodiscard]] sim::Scenario scenario_of(const Candidate& combination) const;
};

/// arguments: "NAME=FIRST:LAST:STEP", "NAME=FIRST:LAST" with a step of 1, or "NAME=VALUE". LAST is included if a
/// step ends there. Checks each value on the scenario. settings: the arguments of `--set`, which the scenario has
/// already. Throws InputError, also if a swept quantity replaces a setting, an override of the scenario or another
/// quantity entirely.
[[nodiscard]] Sweep read_sweep(sim::Scenario scenario, std::span<const std::string> arguments,
                               std::vector<std::string> settings = {});

/// The options that hold for all runs: "--set frequency=1.5 --seconds 30 --friction 0.2".
[[nodiscard]] std::string fixed_options(const Sweep& sweep);
/// The command that repeats the sweep.
[[nodiscard]] std::string command_of(const Sweep& sweep);

/// Simulates the combinations of tasks, together if the engine can.
[[nodiscard]] std::vector<TrialResult> run_combinations(const Sweep& sweep, std::span<const Task> tasks);

struct SweepRun {
  std::uint64_t number = 0;  ///< number of the combination
  TrialResult result;
};

/// Gives all combinations but those of `runs` to the workers, whose function must be run_combinations. Returns all
/// results in the order of the combinations; only the finished ones if `stop` becomes true. observe: called with the
/// results so far after each result, which is the last of them, and after half a second without one.
[[nodiscard]] std::vector<SweepRun> run_sweep(const Sweep& sweep, Workers& workers, std::vector<SweepRun> runs,
                                              const std::function<bool()>& stop,
                                              const std::function<void(std::span<const SweepRun>)>& observe);

/// The runs that differ only in their seed.
struct SweepGroup {
  Candidate combination;                   ///< with the first seed
  std::vector<double> values;              ///< values of the measure, from runs that have one
  [[nodiscard]] double mean() const;       ///< NaN without values
  [[nodiscard]] double deviation() const;  ///< standard deviation of the sample; NaN below two values
};

/// Groups the runs, in the order of the combinations.
[[nodiscard]] std::vector<SweepGroup> group_runs(const Sweep& sweep, std::span<const SweepRun> runs,
                                                 sim::Measure measure);

/// SHA-256 over the files of the scenario, in their order, its algorithms and the program (result_key:
/// tools/proleg/common/build_id.hpp).
[[nodiscard]] std::string sweep_inputs(const Sweep& sweep, const std::string& result_key);
/// The head of the table of all runs: comments with the command, and with sweep_inputs(); the names of the columns.
[[nodiscard]] std::string sweep_head(const Sweep& sweep, const std::string& result_key);
/// A line of that table: the swept values, all measures, the number of joints whose servos cannot follow, and why the
/// run failed.
[[nodiscard]] std::string sweep_line(const Sweep& sweep, const SweepRun& run);
/// The runs of a table of this sweep, with lines in any order. A last line without its end is left out. name: of the
/// file, for errors. Throws InputError if it is that of another command, of other files or of another program, or is
/// damaged.
[[nodiscard]] std::vector<SweepRun> read_sweep_table(const Sweep& sweep, const std::string& result_key,
                                                     const std::string& name, std::string_view text);
/// Lines of a table before the first run.
inline constexpr int sweep_head_lines = 3;

struct SweepTable {
  std::string inputs;  ///< sweep_inputs() of the sweep that has written it; empty: the table has no head yet
  std::vector<SweepRun> runs;
};
/// The table of a sweep that may still write it, also with other files or by another program. sweep: its quantities;
/// the scenario does not matter. Throws InputError if it is that of another sweep, or is damaged.
[[nodiscard]] SweepTable look_at_sweep_table(const Sweep& sweep, const std::string& name, std::string_view text);
/// A comment with the command; then a line for each group: the swept values without the seed, number of values, mean,
/// standard deviation, minimum, maximum.
[[nodiscard]] std::string sweep_summary(const Sweep& sweep, std::span<const SweepGroup> groups, sim::Measure measure);

/// Positions of the quantities other than the seed that have several values.
[[nodiscard]] std::vector<std::size_t> varied_quantities(const Sweep& sweep);

/// Draws the measure over one quantity (its mean as a line, all values as dots) or over two (a map of the means), with
/// a gap where no run has a value. The text is empty if no quantity or more than two vary, or if no run has a value.
[[nodiscard]] std::string draw_sweep(const Sweep& sweep, std::span<const SweepGroup> groups, sim::Measure measure);

}  // namespace proleg::optimize
