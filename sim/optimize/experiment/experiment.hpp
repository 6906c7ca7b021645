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

/// A search for the parameters of a gait, as a *.optimise.xml file describes it.
struct Experiment {
  std::string path;
  int method_line = 0;     ///< of path, where the method's settings begin; 0: none
  sim::Scenario scenario;  ///< read from its file; its remarks include those on this file
  SearchSpace space;
  std::vector<Objective> objectives;  ///< at least one
  double heading_deg = 0.0;           ///< direction of `speed`: 0 is that of the head at the start, 90 its left
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

/// Short name of a method: great-deluge, genetic, or pagmo's name.
[[nodiscard]] std::string method_name(const MethodSettings& method);

}  // namespace proleg::optimize
