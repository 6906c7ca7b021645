#include "sim/optimize/confirm/perturbed_worlds.hpp"

#include <algorithm>
#include <cmath>

#include "shared/computer/errors/input_error.hpp"
#include "shared/fixed/random.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/loop/simulation_batch.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/random_streams.hpp"

namespace proleg::optimize {
namespace {

constexpr std::size_t most_in_batch = 16;

sim::Scenario perturbed(sim::Scenario scenario, const WorldVariation& variation, std::uint64_t seed) {
  perturb(scenario, variation.spread, seed);
  Pcg32 random(seed, sim::random_stream::start);
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const double draw = std::ldexp(static_cast<double>(random.next()), -31) - 1.0;  // -1 to 1
    scenario.environment.robot_pose.position[axis] += draw * variation.start_m;
  }
  return scenario;
}

class Worlds {
 public:
  Worlds(const sim::Scenario& scenario, std::uint32_t count, std::uint64_t seed, const WorldVariation& variation,
         const std::function<void(double share)>& progress, const DistanceOf& distance_of)
      : progress_(progress),
        distance_of_(distance_of),
        size_of_batch_(scenario.environment.engine == sim::PhysicsEngine::reduced ? most_in_batch : 1) {
    for (std::uint32_t world = 0; world < count; ++world) {
      scenarios_.push_back(perturbed(scenario, variation, trial_seed(seed, 0, 0, world)));
    }
  }

  WorldDistances run() {
    for (std::size_t first = 0; first < scenarios_.size(); first += size_of_batch_) {
      const std::size_t count = std::min(size_of_batch_, scenarios_.size() - first);
      if (count == 1) {
        run_alone(first);
      } else {
        run_together(first, count);
      }
    }
    std::ranges::sort(result_.distances);
    return std::move(result_);
  }

 private:
  void keep(double distance, bool has_failed) {
    if (has_failed || !std::isfinite(distance)) {
      ++result_.failed;
    } else {
      result_.distances.push_back(distance);
    }
  }

  void show(std::size_t first, std::size_t count, double share) const {
    progress_((static_cast<double>(first) + share * static_cast<double>(count)) /
              static_cast<double>(scenarios_.size()));
  }

  void run_alone(std::size_t number) {
    const std::uint32_t ticks = sim::tick_count(scenarios_[number]);
    try {
      sim::Simulation simulation(scenarios_[number]);
      simulation.leave_out_hashes();
      while (simulation.tick() < ticks) {
        simulation.advance();
        show(number, 1, static_cast<double>(simulation.tick()) / ticks);
      }
      keep(distance_of_(simulation.plant()), false);
    } catch (const sim::PhysicsError&) {
      keep(0.0, true);
    } catch (const InputError&) {
      keep(0.0, true);
    }
  }

  void run_together(std::size_t first, std::size_t count) {
    std::vector<const sim::Scenario*> members;
    for (std::size_t i = first; i < first + count; ++i) {
      members.push_back(&scenarios_[i]);
    }
    sim::SimulationBatch batch(members);
    const std::uint32_t ticks = sim::tick_count(scenarios_.front());
    for (std::uint32_t tick = 1; tick <= ticks; ++tick) {
      batch.advance();
      show(first, count, static_cast<double>(tick) / ticks);
    }
    for (std::size_t i = 0; i < batch.size(); ++i) {
      keep(distance_of_(batch.simulation(i).plant()), !batch.failure(i).empty());
    }
  }

  const std::function<void(double share)>& progress_;
  const DistanceOf& distance_of_;
  std::size_t size_of_batch_;
  std::vector<sim::Scenario> scenarios_;
  WorldDistances result_;
};

}  // namespace

WorldDistances distances_in_worlds(const sim::Scenario& scenario, std::uint32_t count, std::uint64_t seed,
                                   const WorldVariation& variation, const std::function<void(double share)>& progress,
                                   const DistanceOf& distance_of) {
  return Worlds(scenario, count, seed, variation, progress, distance_of).run();
}

}  // namespace proleg::optimize
