#pragma once

// An optimisation experiment, as its *.optimise.xml file describes it: its objectives, the settings of its method
// section, and all else; and its parts as text, of which its fingerprint is made.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/measure/measure.hpp"
#include "sim/optimize/experiment/search_space.hpp"
#include "sim/optimize/experiment/trials.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// A measure and its factor in a weighted sum.
struct Term {
  sim::Measure measure = sim::Measure::distance;
  double weight = 1.0;
};

enum class Goal : std::uint8_t { maximise, minimise };

/// Rates a candidate: a weighted sum of measures. An optimiser with several objectives searches for the candidates that
/// no other dominates.
struct Objective {
  std::string name;         ///< unique; for columns and axes; by default the name of a single measure
  std::vector<Term> terms;  ///< at least one
  Goal goal = Goal::maximise;
  /// Score of a candidate whose run failed or lacks a measure.
  double failed = 0.0;

  /// Whether the sum of these measures is a finite number.
  [[nodiscard]] bool is_defined(const sim::MeasureValues& measures) const;
  /// The score of a run; `failed` if it is not defined.
  [[nodiscard]] double score(const sim::MeasureValues& measures) const;
  /// Whether a score can be below 0, because of a failed run, a weight below 0, or a measure with both signs.
  [[nodiscard]] bool may_be_negative() const;
  /// Whether score a is better than b.
  [[nodiscard]] bool better(double a, double b) const { return goal == Goal::maximise ? a > b : a < b; }
  /// Unit of the score: the unit of its measure; empty for a sum.
  [[nodiscard]] std::string_view unit() const;
  /// The number that pagmo minimises: the score or its negative. The same function turns a cost into the score.
  [[nodiscard]] double cost(double score) const { return goal == Goal::maximise ? -score : score; }
};

/// Where a search starts: at random candidates only, or with the scenario's own values among the first ones.
enum class Start : std::uint8_t { random, scenario };

/// The modified great deluge algorithm (thesis, section 3.4.2; after G. Dueck, "New optimization heuristics: the great
/// deluge algorithm and the record-to-record travel", J. Comput. Phys. 104, 1993). Points that the thesis leaves open
/// are options. Their defaults read its text literally: a radius that is "increased by itself" doubles.
struct GreatDelugeSettings {
  double water_level = 0.15;      ///< the score that the first accepted candidate must reach
  double rain = 0.01;             ///< rise of the water for each accepted candidate; above 0
  std::uint32_t credits = 10;     ///< times that the search may restart with its first radius
  std::uint32_t retries = 200;    ///< failures in a row that use a credit; at least 1
  std::uint32_t confidence = 20;  ///< failures after which the radius grows; at least 1
  std::uint32_t step = 1;         ///< first radius, in steps of each parameter's value set; at least 1
  enum class Growth : std::uint8_t { linear, doubling } growth = Growth::doubling;
  enum class Move : std::uint8_t { all, one } move = Move::all;  ///< parameters that a candidate changes
  enum class Neighbour : std::uint8_t {
    three,    ///< -radius, 0 or +radius
    sign,     ///< -radius or +radius
    uniform,  ///< any step from -radius to +radius
  } neighbour = Neighbour::three;
  Start start = Start::random;      ///< scenario: all chains start at its values
  bool first_must_pass = true;      ///< whether the start must reach the water level to be accepted
  std::uint32_t reevaluations = 0;  ///< further evaluations of a candidate that would be accepted; the mean decides
  std::uint32_t chains = 1;         ///< searches side by side, each with its own water; the best of all counts
  std::optional<double> target;     ///< stops when a score reaches it
};

/// A genetic algorithm with the settings of GAlib (M. Wall, GAlib 2.4 documentation), which the thesis used.
struct GeneticSettings {
  std::uint32_t population = 30;                  ///< popsize; 2 to 10000
  double mutation = 0.01;                         ///< pmut, a gene's probability; 0 to 1
  double crossover = 0.9;                         ///< pcross; 0 to 1
  std::uint32_t generations_to_convergence = 50;  ///< nconvergence; 1 to 10000
  double convergence = 0.99;                      ///< pconvergence: of best-of-generation scores; 0 to 1
  /// gamode: a setting of the thesis's program that the thesis does not explain. 1: a whole new generation each time,
  /// and the best survives (GAlib's simple algorithm). 2: overlapping generations, half of them new (steady state).
  enum class Mode : std::uint8_t { simple = 1, steady_state = 2 } mode = Mode::simple;
  Start start = Start::random;  ///< scenario: its values are in the first population
};

/// One of pagmo's algorithms.
struct PagmoSettings {
  std::string algorithm;  ///< pagmo's name: cmaes, de, nsga2, sade, de1220, pso, sga, xnes, ...
  std::uint32_t population = 20;
  std::uint32_t generations = 1000;  ///< largest number of generations
  /// After this number of generations in which the best score improves by less than a thousandth, the search restarts
  /// from another random population, for landscapes with several summits. It then ends with its generations or
  /// evaluations. 0: it never restarts. The setting is only for algorithms that evolve by generation.
  std::uint32_t restart_after = 0;
  Start start = Start::random;      ///< scenario: its values are in the first population; not after a restart
  std::optional<double> sigma0;     ///< cmaes, xnes: first step size, as a share of the ranges
  std::optional<double> crossover;  ///< de, sga, nsga2: their CR, cr
  std::optional<double> scale;      ///< de: F
  std::optional<double> mutation;   ///< sga, nsga2: their m
};

/// MAP-Elites: a map over measures of the run (Experiment::axes) keeps the best candidate of each of its cells, and new
/// candidates are variations of those (J.-B. Mouret, J. Clune, "Illuminating search spaces by mapping elites",
/// arXiv:1504.04909, 2015). The variation is Iso+LineDD (V. Vassiliades, J.-B. Mouret, "Discovering the elite
/// hypervolume by leveraging interspecies correlation", GECCO 2018): of each value of one of them by noise of its own,
/// and of all values on the line to another one.
struct MapElitesSettings {
  std::uint32_t population = 256;    ///< candidates of a generation
  std::uint32_t generations = 1000;  ///< largest number of generations after the first
  std::uint32_t first = 1000;        ///< random candidates of the first generation
  double noise = 0.02;               ///< standard deviation of the noise, as a share of a value's range
  double line = 0.2;                 ///< standard deviation on the line, as a share of the distance
  std::uint32_t centroids = 0;       ///< cells of the map, of about equal size (Tessellation); 0: a grid of the axes
  Start start = Start::random;       ///< scenario: its values are among the first
};

/// The options above that an algorithm of pagmo has: sigma0, ...
[[nodiscard]] std::vector<std::string> pagmo_options(std::string_view algorithm);

using MethodSettings = std::variant<GreatDelugeSettings, GeneticSettings, PagmoSettings, MapElitesSettings>;

/// An axis of a map of gaits: the range of a measure.
struct MapAxis {
  sim::Measure measure = sim::Measure::distance;
  double lowest = 0.0;      ///< in the measure's unit; a value below is in the first cell
  double highest = 1.0;     ///< above lowest; a value above is in the last cell
  std::uint32_t cells = 2;  ///< of equal width, 2 to max_map_cells; 0 if the map has centroids
};

inline constexpr std::size_t min_map_axes = 2;
inline constexpr std::size_t max_map_axes = 4;
inline constexpr std::size_t max_map_cells = 50'000;  ///< of all axes together
inline constexpr std::size_t min_centroids = 2;
inline constexpr std::size_t max_centroids = 10'000;

/// Settings that stop a candidate early if it will not come near the score it needs. Racing is possible only for one
/// objective, which is the distance or the speed.
struct Racing {
  double after = 0.0;  ///< share of the run after which a candidate is checked; 0: no racing; below 1
  /// Share of the needed score (the water level, or the best so far) that the extrapolated score must reach.
  double keep = 0.5;

  [[nodiscard]] bool on() const { return after > 0.0; }
};

/// The choice of the winner of a noisy search: the best candidates are rated again in fresh runs.
struct ConfirmationSettings {
  std::uint32_t candidates = 5;  ///< number of candidates, 1 to 1000
  std::uint32_t runs = 10;       ///< runs of each candidate, 0 to 1000; 0: the best score of the search wins
};

/// Objectives of an experiment.
inline constexpr std::size_t max_objectives = 8;

/// A search for the parameters of a gait, as a *.optimise.xml file describes it.
struct Experiment {
  std::string path;
  int method_line = 0;          ///< of path, where the method's settings begin; 0: none
  bool on_robot = false;        ///< a robot makes the trials, and no engine (put_on_robot())
  std::string simulated_robot;  ///< what makes the trials on_robot, if it is no real robot; otherwise empty
  sim::Scenario scenario;       ///< read from its file; its remarks include those on this file
  SearchSpace space;
  std::vector<Objective> objectives;  ///< at least one
  /// Of MAP-Elites, otherwise none. Objective 1 + i is the measure of axis i; its `failed` marks a run without it.
  std::vector<MapAxis> axes;
  double heading_deg = 0.0;  ///< direction of `speed`: 0 is that of the head at the start, 90 its left
  Trials trials;
  Racing racing;
  ConfirmationSettings confirmation;
  /// Whether evaluation 0 is the candidate that is nearest to the scenario's own values. A file's experiment has it.
  bool has_baseline = false;
  bool reuse = true;  ///< whether known outcomes that cannot differ are not simulated again
  MethodSettings method;
  std::uint64_t seed = 1;
  std::uint64_t evaluations = 0;         ///< largest number of evaluations; 0: the search runs until the method ends
  std::vector<sim::SourceFile> sources;  ///< all files read, first the experiment's, then the scenario's

  /// Title from the path: "great_deluge" for "travelling_wave/great_deluge.optimise.xml".
  [[nodiscard]] std::string title() const;
  /// SHA-256 of all settings and files that determine the result, except `evaluations`. 64 hexadecimal digits.
  [[nodiscard]] std::string fingerprint() const;
};

/// Reads a *.optimise.xml file (docs/optimisation-files.md; the thesis's listing B.7 with additions) and the scenario
/// that it names. simulation: a scenario to use instead (files of the thesis name none). Throws InputError.
[[nodiscard]] Experiment read_experiment(const std::filesystem::path& path, sim::FileSource& files,
                                         const std::optional<std::filesystem::path>& simulation = std::nullopt);

/// The same of a scenario that was read before; <simulation> has no effect then.
[[nodiscard]] Experiment read_experiment(const std::filesystem::path& path, sim::FileSource& files,
                                         sim::Scenario scenario);

/// Gives each candidate so many worlds, 1 to max_trials. If nothing lets them differ, they differ as usual_spread()
/// says.
void set_trials(Experiment& experiment, std::uint32_t count);

/// Lets a robot make the trials. They have no variations of the world and no racing; a candidate has as many trials as
/// before. The fingerprint becomes another one: results of a robot, of a simulated robot and of a simulation share no
/// store. simulated: Experiment::simulated_robot.
void put_on_robot(Experiment& experiment, const std::string& simulated);

/// The name of the part of an experiment that says which simulated robot makes the trials.
inline constexpr const char* simulated_robot_part = "simulated robot";

/// The name of a robot among the names of engines.
inline constexpr const char* robot_name = "robot";
/// What makes the trials: the name of the engine, or robot_name.
[[nodiscard]] std::string_view trial_maker(const Experiment& experiment);

/// Number of evaluations that a search makes if it does not end earlier: its budget, or that of its generations if it
/// is lower. 0: unknown.
[[nodiscard]] std::uint64_t planned_evaluations(const Experiment& experiment);

/// Short name of a method: great-deluge, genetic, map-elites, or pagmo's name.
[[nodiscard]] std::string method_name(const MethodSettings& method);

/// A part of an experiment as exact text: two experiments agree in the part if the texts are equal.
struct ExperimentPart {
  std::string name;  ///< for messages: "method", "search space"
  std::string text;
};

/// All parts that determine the results, except the scenario. The fingerprint is made of them, and a store keeps them
/// to name differences.
[[nodiscard]] std::vector<ExperimentPart> parts_of(const Experiment& experiment);

/// Text of an objective: weight * measure + ...
[[nodiscard]] std::string terms_text(const Objective& objective);

}  // namespace proleg::optimize
