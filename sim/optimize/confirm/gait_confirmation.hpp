#pragma once

// Whether a gait is real or lives on an error of the physics. A search finds both: an optimiser uses whatever moves the
// robot, also a start that jumps or a solver that gives energy. A real gait moves about as far with a finer step, in
// another engine and in worlds that differ a little, and its energy comes from the motors.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/loop/plant.hpp"
#include "sim/optimize/experiment/trials.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// How much the worlds differ.
struct WorldVariation {
  Spread spread;
  double start_m = 0.0;  ///< the start is moved along x and y, each by up to this in either direction
};

struct WorldDistances {
  std::vector<double> distances;  ///< m, ascending
  std::uint32_t failed = 0;       ///< worlds without a distance
};

/// How far a robot has come at the end of a run, in m: by default in any direction.
using DistanceOf = std::function<double(const sim::Plant&)>;

/// Runs the scenario in `count` worlds, in the scenario's engine; the same seed gives the same worlds. progress: called
/// often with the share that is done; it may throw.
[[nodiscard]] WorldDistances distances_in_worlds(const sim::Scenario& scenario, std::uint32_t count, std::uint64_t seed,
                                                 const WorldVariation& variation,
                                                 const std::function<void(double share)>& progress,
                                                 const DistanceOf& distance_of = &sim::Plant::displacement);

/// A run of the gait's scenario.
struct ConfirmedRun {
  std::string name;  ///< "as it is", "a finer step"
  sim::PhysicsEngine engine = sim::PhysicsEngine::ode;
  double step_s = 0.0;
  std::string failure{};      ///< why it has no result; empty if it has one
  bool is_refused = false;    ///< the engine does not have what the scenario needs
  double distance = 0.0;      ///< m
  double first_share = 0.0;   ///< of the time: one second, or a tenth if that is shorter
  double first_second = 0.0;  ///< m, distance in that time
  sim::Plant::EnergyBalance energy{};
  double energy_gains = 0.0;  ///< J: sum of unexplained energy over the ticks in which it grew
};

/// What is worth knowing, and whether it speaks for a real gait.
struct ConfirmationFinding {
  std::string name;
  std::string text;
  bool is_good = true;    ///< nothing here is against the gait
  bool was_asked = true;  ///< false: the question could not be asked, which is no doubt
};

struct GaitConfirmation {
  std::vector<ConfirmedRun> runs;  ///< the first one: as it is
  sim::PhysicsEngine perturbed_engine = sim::PhysicsEngine::ode;
  std::vector<double> perturbed;    ///< m, distances in worlds that differ (usual_spread()), ascending
  std::uint32_t failed_worlds = 0;  ///< worlds without a distance
  std::vector<ConfirmationFinding> findings;

  [[nodiscard]] bool is_real() const;
};

struct ConfirmationOptions {
  std::uint32_t worlds = 50;
  std::uint64_t seed = 1;
};

/// How much the start of the worlds differs, beside their usual_spread().
inline constexpr double confirmation_start_m = 0.005;

/// progress: called often with the share that is done; when it returns true, this throws SearchEnded.
[[nodiscard]] GaitConfirmation confirm_gait(const sim::Scenario& scenario, const ConfirmationOptions& options,
                                            const std::function<bool(double share)>& progress);

/// What the runs of a gait say about it. confirmation: its findings are not read.
[[nodiscard]] std::vector<ConfirmationFinding> findings_of(const GaitConfirmation& confirmation);

/// The page: a table of the runs, the worlds, and a line for each finding.
[[nodiscard]] std::string confirmation_text(const GaitConfirmation& confirmation);

}  // namespace proleg::optimize
