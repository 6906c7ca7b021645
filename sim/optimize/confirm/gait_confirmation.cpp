#include "sim/optimize/confirm/gait_confirmation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/random.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/loop/simulation_batch.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/scenario.hpp"

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

using sim::PhysicsEngine;

using Progress = std::function<void(double share)>;

std::uint32_t first_ticks(const sim::Scenario& scenario) {
  const std::uint32_t ticks = sim::tick_count(scenario);
  const auto second = static_cast<std::uint32_t>(1'000'000 / scenario.kernel.tick_period_us);
  return std::max(std::min(second, ticks / 10), 1U);
}

ConfirmedRun run(const sim::Scenario& scenario, std::string name, const Progress& progress) {
  ConfirmedRun result{std::move(name), scenario.environment.engine, scenario.step_s};
  const std::uint32_t ticks = sim::tick_count(scenario);
  result.first_share = static_cast<double>(first_ticks(scenario)) / ticks;
  try {
    sim::Simulation simulation(scenario);
    simulation.leave_out_hashes();
    double unexplained = 0.0;
    while (simulation.tick() < ticks) {
      simulation.advance();
      result.energy = simulation.plant().energy_balance();
      result.energy_gains +=
          std::max(result.energy.unexplained - std::exchange(unexplained, result.energy.unexplained), 0.0);
      if (simulation.tick() == first_ticks(scenario)) {
        result.first_second = simulation.plant().displacement();
      }
      progress(static_cast<double>(simulation.tick()) / ticks);
    }
    result.distance = simulation.plant().displacement();
  } catch (const sim::PhysicsError& error) {
    result.failure = error.what();
  } catch (const InputError& error) {
    result.is_refused = true;
    result.failure = error.what();
  }
  return result;
}

/// Half the step, or 1 ms if that is finer; a tick is a whole number of both.
sim::Scenario with_finer_step(sim::Scenario scenario) {
  constexpr double fine_s = 0.001;
  const double tick_s = scenario.kernel.tick_period_us * 1e-6;
  const double half = scenario.step_s / 2.0;
  scenario.step_s = half > fine_s ? tick_s / std::ceil(tick_s / fine_s) : half;
  return scenario;
}

sim::Scenario with_engine(sim::Scenario scenario, PhysicsEngine engine) {
  scenario.environment.engine = engine;
  return scenario;
}

/// The engines other than this one; the first one supports most robots.
std::vector<PhysicsEngine> engines_beside(PhysicsEngine engine) {
  std::vector<PhysicsEngine> others;
  for (const sim::PhysicsEngineName& name : sim::physics_engines) {
    if (name.engine != engine) {
      others.push_back(name.engine);
    }
  }
  return others;
}

// Limits. The shipped gaits: half the step changes the distance by 1 to 14 % (most on the terrace), the other engine by
// 1 to 5 %, MuJoCo by up to 8 %; contacts give 1 to 2 % of the motors' work; the first second has 0.8 to 1.6 times the
// average speed.
constexpr double max_difference = 0.2;     // of distances
constexpr double negligible_m = 0.02;      // differences below are none
constexpr double min_median = 0.7;         // of the distances in other worlds, share of the distance
constexpr double max_energy_gains = 0.05;  // share of the motors' work
constexpr double max_start = 3.0;          // times the average speed

std::string percent(double share) { return number_text(std::round(1000.0 * share) / 10.0) + " %"; }
std::string metres(double distance) { return number_text(std::round(1e4 * distance) / 1e4) + " m"; }

ConfirmationFinding compare(const std::string& name, const ConfirmedRun& first, const ConfirmedRun& other) {
  if (!other.failure.empty()) {
    return {name, "no result: " + other.failure, false};
  }
  const double difference = std::abs(other.distance - first.distance);
  return {name,
          metres(other.distance) + " instead of " + metres(first.distance) + ", " +
              percent(difference / std::max(first.distance, negligible_m)) + " (limit " + percent(max_difference) + ")",
          difference <= std::max(max_difference * first.distance, negligible_m)};
}

ConfirmationFinding of_other_worlds(const GaitConfirmation& confirmation) {
  const std::vector<double>& distances = confirmation.perturbed;
  const std::string name = "worlds that differ";
  if (confirmation.failed_worlds > 0 || distances.empty()) {
    return {name, std::to_string(confirmation.failed_worlds) + " without a result", false};
  }
  const auto quantile = [&](double share) {
    return distances[static_cast<std::size_t>(share * static_cast<double>(distances.size() - 1))];
  };
  const double nominal = confirmation.runs.front().distance;
  std::string text = "median " + metres(quantile(0.5)) + " (at least " + metres(min_median * nominal) +
                     "), a tenth below " + metres(quantile(0.1));
  if (quantile(0.1) < min_median * nominal) {
    text += ": it works in some of the worlds only";  // fragile, but not unreal
  }
  return {name, text, quantile(0.5) >= std::min(min_median * nominal, nominal - negligible_m)};
}

ConfirmationFinding of_energy(const ConfirmedRun& run) {
  const double share = run.energy_gains / std::max(run.energy.motors, 1e-9);
  return {"energy",
          "contacts gave " + number_text(std::round(1e3 * run.energy_gains) / 1e3) + " J, " + percent(share) +
              " of the " + number_text(std::round(1e3 * run.energy.motors) / 1e3) + " J of the motors (limit " +
              percent(max_energy_gains) + ")",
          share <= max_energy_gains};
}

ConfirmationFinding of_start(const ConfirmedRun& run) {
  const double ratio = run.first_second / std::max(run.distance * run.first_share, 1e-9);
  return {"start",
          metres(run.first_second) + " in the first " + percent(run.first_share) + " of the time, " +
              number_text(std::round(100.0 * ratio) / 100.0) + " times the average (limit " + number_text(max_start) +
              ")",
          ratio <= max_start || run.first_second <= negligible_m};
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string right(double value, int decimals, std::size_t width) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return std::string(width > std::string(text).size() ? width - std::string(text).size() : 0, ' ') + text;
}

std::string line_of(const ConfirmedRun& run) {
  std::string line = "  " + padded(run.name, 32) + padded(std::string(sim::name_of(run.engine)), 9) +
                     padded(number_text(run.step_s * 1e3) + " ms", 10);
  if (!run.failure.empty()) {
    return line + (run.is_refused ? "-" : run.failure) + "\n";
  }
  return line + right(run.distance, 4, 8) + right(run.energy.motors, 3, 10) + right(run.energy.friction, 3, 10) +
         right(run.energy.stored, 3, 9) + right(run.energy_gains, 3, 9) +
         right(run.energy_gains - run.energy.unexplained, 3, 9) + "\n";
}

}  // namespace

WorldDistances distances_in_worlds(const sim::Scenario& scenario, std::uint32_t count, std::uint64_t seed,
                                   const WorldVariation& variation, const std::function<void(double share)>& progress,
                                   const DistanceOf& distance_of) {
  return Worlds(scenario, count, seed, variation, progress, distance_of).run();
}

bool GaitConfirmation::is_real() const { return std::ranges::all_of(findings, &ConfirmationFinding::is_good); }

std::vector<ConfirmationFinding> findings_of(const GaitConfirmation& confirmation) {
  const ConfirmedRun& first = confirmation.runs.front();
  if (!first.failure.empty()) {
    return {{"as it is", "no result: " + first.failure, false}};
  }
  std::vector<ConfirmationFinding> findings;
  for (const ConfirmedRun& run : confirmation.runs) {
    if (&run == &first) {
      continue;
    }
    if (run.is_refused) {
      findings.push_back({run.name, "not compared: " + run.failure, true, false});
    } else {
      findings.push_back(compare(run.name, first, run));
    }
  }
  findings.push_back(of_other_worlds(confirmation));
  findings.push_back(of_energy(first));
  findings.push_back(of_start(first));
  return findings;
}

GaitConfirmation confirm_gait(const sim::Scenario& scenario, const ConfirmationOptions& options,
                              const std::function<bool(double share)>& progress) {
  // Shares of the time: the five runs that are shown, then the worlds.
  constexpr double share_of_run = 0.1;
  double done = 0.0;
  double part = share_of_run;
  const Progress show = [&](double share) {
    if (progress && progress(done + part * share)) {
      throw SearchEnded{};
    }
  };
  GaitConfirmation result;
  const auto add = [&](const sim::Scenario& changed, std::string name) {
    result.runs.push_back(run(changed, std::move(name), show));
    done += share_of_run;
  };
  add(scenario, "as it is");
  add(with_finer_step(scenario), "a finer step");
  const std::vector<PhysicsEngine> others = engines_beside(scenario.environment.engine);
  const sim::Scenario elsewhere = with_engine(scenario, others.front());
  add(elsewhere, "the other engine");
  if (!result.runs.back().is_refused) {
    add(with_finer_step(elsewhere), "the other engine, a finer step");
  }
  for (const PhysicsEngine third : std::span(others).subspan(1)) {
    add(with_engine(scenario, third), std::string(sim::title_of(third)));
  }
  // The reduced engine is twenty times as fast; what it does not have runs in ODE.
  const bool has_reduced = std::ranges::any_of(
      result.runs, [](const ConfirmedRun& its) { return its.engine == PhysicsEngine::reduced && its.failure.empty(); });
  result.perturbed_engine = has_reduced ? PhysicsEngine::reduced : PhysicsEngine::ode;
  part = 1.0 - done;
  WorldDistances worlds = distances_in_worlds(with_engine(scenario, result.perturbed_engine), options.worlds,
                                              options.seed, {usual_spread(), confirmation_start_m}, show);
  result.perturbed = std::move(worlds.distances);
  result.failed_worlds = worlds.failed;
  result.findings = findings_of(result);
  return result;
}

std::string confirmation_text(const GaitConfirmation& confirmation) {
  std::string text =
      "run                               engine   step      distance    motors  friction   stored    gained     lost\n"
      "                                                            m         J         J        J         J        J\n";
  for (const ConfirmedRun& run : confirmation.runs) {
    text += line_of(run);
  }
  text += "\n";
  for (const ConfirmationFinding& finding : confirmation.findings) {
    text += (!finding.was_asked ? "  -      "
             : finding.is_good  ? "  ok     "
                                : "  DOUBT  ") +
            padded(finding.name, 33) + finding.text + "\n";
  }
  return text + "\n" +
         (confirmation.is_real() ? "Nothing speaks against this gait.\n"
                                 : "This gait may live on an error of the physics.\n");
}

}  // namespace proleg::optimize
