#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/experiment/fitness.hpp"
#include "sim/optimize/experiment/method_settings.hpp"
#include "sim/optimize/experiment/search_space.hpp"
#include "sim/optimize/experiment/trials.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// Stops a candidate early if it will not come near the score it needs. Only for one objective that is the distance or
/// the speed.
struct Racing {
  double after = 0.0;  ///< share of the run after which a candidate is checked; 0: no racing; below 1
  /// Share of the needed score (the water level, or the best so far) that its extrapolated score must reach.
  double keep = 0.5;

  [[nodiscard]] bool on() const { return after > 0.0; }
};

/// How the winner of a noisy search is chosen: the best candidates are rated again in fresh runs.
struct ConfirmationSettings {
  std::uint32_t candidates = 5;  ///< 1 to 1000
  std::uint32_t runs = 10;       ///< of each; 0: none, and the best score of the search wins; at most 1000
};

/// A search for the parameters of a gait, as a *.optimise.xml file describes it.
struct Experiment {
  std::string path;
  int method_line = 0;     ///< of path, where the method's settings begin; 0: none
  sim::Scenario scenario;  ///< from its file; its remarks include those on this file
  SearchSpace space;
  std::vector<Objective> objectives;  ///< at least one
  double heading_deg = 0.0;  ///< of the measure `speed`: 0 is the direction of the head at the start, 90 its left
  Trials trials;
  Racing racing;
  ConfirmationSettings confirmation;
  /// Whether evaluation 0 is the candidate that is nearest to the scenario's own values. A file's experiment has it.
  bool has_baseline = false;
  bool reuse = true;  ///< whether known outcomes that cannot differ are not simulated again
  MethodSettings method;
  std::uint64_t seed = 1;
  std::uint64_t evaluations = 0;         ///< at most; 0: until the method ends
  std::vector<sim::SourceFile> sources;  ///< every file read, the experiment's own first, then the scenario's

  /// "great_deluge" of "travelling_wave/great_deluge.optimise.xml".
  [[nodiscard]] std::string title() const;
  /// SHA-256 of all that determines the result, except `evaluations`: settings and files. 64 hexadecimal digits.
  [[nodiscard]] std::string fingerprint() const;
};

/// Reads a *.optimise.xml file (docs/optimisation-files.md; the thesis's listing B.7 with additions) and the scenario
/// that it names. simulation: a scenario to use instead (files of the thesis name none). Throws InputError.
[[nodiscard]] Experiment read_experiment(const std::filesystem::path& path, sim::FileSource& files,
                                         const std::optional<std::filesystem::path>& simulation = std::nullopt);

/// Short name of a method: great-deluge, genetic, or that of pagmo.
[[nodiscard]] std::string method_name(const MethodSettings& method);

}  // namespace proleg::optimize
