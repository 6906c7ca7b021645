#pragma once

// Changes of how a draft is run: duration, tick, step, seed, engine, gravity. The values are in its Scenario.

#include <cstdint>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "sim/authoring/draft.hpp"
#include "sim/environment/environment_model.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The words of <solver>, in the order of Solver.
[[nodiscard]] std::string_view word_of(Solver solver);
[[nodiscard]] std::optional<Solver> solver_named(std::string_view word);

/// Each call writes one value into the top-level file or the environment file, as the scenario reader takes it; the
/// reader judges the ranges.
class RunChange {
 public:
  /// scenario: of the draft, before the change.
  RunChange(const Scenario& scenario, DraftChange& change) : scenario_(scenario), change_(change) {}

  void set_duration(double seconds);
  void set_seed(std::uint64_t seed);
  void set_tick(double milliseconds);
  void set_step(double milliseconds);
  void set_solver(Solver solver);
  void set_contact_noise(double probability);
  void set_engine(PhysicsEngine engine);
  void set_gravity(const Eigen::Vector3d& metres_per_s2);
  void set_self_collision(bool is_on);

 private:
  /// Sets a tag of <simulationProperties>.
  void set_property(std::string_view tag, const std::string& content);
  /// The element <physicsengine> of the environment, which is made if there is none.
  [[nodiscard]] ElementNumber physics();
  /// Sets a tag of the engine's properties.
  void set_physics(std::string_view tag, const std::string& content);

  const Scenario& scenario_;
  DraftChange& change_;
};

}  // namespace proleg::sim
