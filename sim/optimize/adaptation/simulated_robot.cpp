#include "sim/optimize/adaptation/simulated_robot.hpp"

#include <cmath>
#include <utility>

#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/physics/physics_error.hpp"

namespace proleg::optimize {

SimulatedRobot::SimulatedRobot(const Experiment& experiment, sim::Scenario reality, sim::Losses losses,
                               std::function<bool()> stop)
    : experiment_(experiment), reality_(std::move(reality)), losses_(std::move(losses)), stop_(std::move(stop)) {}

TrialOutcome outcome_of(const Objective& objective, const sim::MeasureValues& measures) {
  return {objective.score(measures),
          objective.is_defined(measures) ? std::string() : "the run does not define " + objective.name};
}

TrialOutcome SimulatedRobot::try_gait(const Candidate& candidate) {
  sim::Scenario scenario = reality_;
  experiment_.space.apply(candidate, scenario);
  const Objective& objective = experiment_.objectives.front();
  try {
    sim::Simulation simulation(scenario, &losses_);
    simulation.leave_out_hashes();
    while (simulation.tick() < sim::tick_count(scenario)) {
      if (stop_()) {
        throw SearchEnded();
      }
      simulation.advance();
    }
    return outcome_of(objective, simulation.measures(experiment_.heading_deg));
  } catch (const sim::PhysicsError& error) {
    return {objective.failed, error.what()};
  }
}

}  // namespace proleg::optimize
