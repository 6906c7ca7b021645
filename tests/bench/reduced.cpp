// Evaluations per second and core of the physics engines, with kernels, sensors and measures, and how well their
// results agree. All figures are of one run and by processor time, so other programs do not affect the ratios. MuJoCo
// has a row for each of two integrators, if it is built in.
//
//   bench_reduced [CANDIDATES]   compared with ODE; by default 200

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation_batch.hpp"
#include "sim/mujoco/mujoco_world.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/bench/candidates.hpp"
#include "tests/support/files.hpp"

namespace {

using namespace proleg;

constexpr std::uint64_t seed = 1;
constexpr std::size_t batch_size = 64;

sim::Scenario read_gait(const std::string& name) {
  sim::DiskFiles files;
  return sim::read_scenario(source_path("/sim/scenarios/travelling_wave/") + name + ".simulation.xml", files);
}

/// Of this thread, s.
double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

struct Evaluations {
  std::vector<double> distances;  ///< m
  double per_second = 0.0;
};

using MakeWorld = std::function<std::unique_ptr<sim::World>(const sim::Scenario&)>;

/// make_world: null for the world of the scenario.
Evaluations alone(std::span<const sim::Scenario> candidates, const MakeWorld& make_world = nullptr) {
  Evaluations result;
  const double start = processor_time();
  for (const sim::Scenario& candidate : candidates) {
    sim::Simulation simulation(candidate, make_world ? make_world(candidate) : nullptr);
    simulation.leave_out_hashes();
    while (simulation.tick() < sim::tick_count(candidate)) {
      simulation.advance();
    }
    result.distances.push_back(simulation.measures()[sim::Measure::distance]);
  }
  result.per_second = static_cast<double>(candidates.size()) / (processor_time() - start);
  return result;
}

Evaluations together(std::span<const sim::Scenario> candidates, const sim::reduced::ChainKernel* kernel) {
  Evaluations result;
  const double start = processor_time();
  for (std::size_t first = 0; first < candidates.size(); first += batch_size) {
    std::vector<const sim::Scenario*> scenarios;
    for (std::size_t i = first; i < std::min(first + batch_size, candidates.size()); ++i) {
      scenarios.push_back(&candidates[i]);
    }
    sim::SimulationBatch batch(scenarios, kernel);
    for (std::uint32_t tick = 0; tick < sim::tick_count(*scenarios.front()); ++tick) {
      batch.advance();
    }
    for (std::size_t i = 0; i < batch.size(); ++i) {
      result.distances.push_back(batch.simulation(i).measures()[sim::Measure::distance]);
    }
  }
  result.per_second = static_cast<double>(candidates.size()) / (processor_time() - start);
  return result;
}

std::vector<sim::Scenario> with_engine(std::vector<sim::Scenario> candidates, sim::PhysicsEngine engine) {
  for (sim::Scenario& candidate : candidates) {
    candidate.environment.engine = engine;
  }
  return candidates;
}

std::vector<double> ranks_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    ranks[order[rank]] = static_cast<double>(rank);
  }
  return ranks;
}

/// Spearman's, for values that differ.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const std::vector<double> ranks_a = ranks_of(a);
  const std::vector<double> ranks_b = ranks_of(b);
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    squares += (ranks_a[i] - ranks_b[i]) * (ranks_a[i] - ranks_b[i]);
  }
  const auto n = static_cast<double>(a.size());
  return 1.0 - 6.0 * squares / (n * (n * n - 1.0));
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

MakeWorld in_mujoco(sim::mujoco::Integrator integrator) {
  return [integrator](const sim::Scenario& scenario) {
    return sim::mujoco::make_mujoco_world(scenario.robot, scenario.environment, scenario.step_s, scenario.path,
                                          integrator);
  };
}

/// other: of the first of the candidates.
void print_agreement(const char* engine, const std::vector<double>& all_of_ode, const std::vector<double>& other) {
  const std::vector<double> ode(all_of_ode.begin(), all_of_ode.begin() + static_cast<std::ptrdiff_t>(other.size()));
  std::vector<double> differences;
  std::vector<double> relative;
  for (std::size_t i = 0; i < ode.size(); ++i) {
    differences.push_back(std::abs(ode[i] - other[i]) * 1000.0);
    relative.push_back(std::abs(ode[i] - other[i]) / ode[i] * 100.0);
  }
  std::printf(
      "%s, distances of %zu candidates (seed %llu): rank correlation %.4f; difference: median %.1f mm or %.2f %%, "
      "90 %% within %.1f mm, worst %.0f mm\n",
      engine, ode.size(), static_cast<unsigned long long>(seed), rank_correlation(ode, other),
      quantile(differences, 0.5), quantile(relative, 0.5), quantile(differences, 0.9), quantile(differences, 1.0));
}

/// Rate of two threads with a batch each against one, by wall-clock time.
double gain_of_two_cores(std::span<const sim::Scenario> candidates) {
  const auto wall_time = [] {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
  };
  const double start = wall_time();
  static_cast<void>(together(candidates, nullptr));
  const double one = wall_time() - start;
  std::thread other([&] { static_cast<void>(together(candidates, nullptr)); });
  static_cast<void>(together(candidates, nullptr));
  other.join();
  return 2.0 * one / (wall_time() - start - one);
}

void run(std::size_t count) {
  const sim::Scenario scenario = read_gait("uniform");
  const std::vector<sim::Scenario> candidates = bench::candidates(scenario, count, seed);
  const std::vector<sim::Scenario> reduced = with_engine(candidates, sim::PhysicsEngine::reduced);
  std::printf("evaluations of %.0f s in a second of one core\n", scenario.duration_s);
  const Evaluations ode = alone(with_engine(candidates, sim::PhysicsEngine::ode));
  std::printf("  %-34s %6.2f\n", "ODE", ode.per_second);
  const auto print = [&](const std::string& name, const Evaluations& result) {
    std::printf("  %-34s %6.1f  %5.2f x ODE\n", name.c_str(), result.per_second, result.per_second / ode.per_second);
  };
  const std::span<const sim::Scenario> some = std::span(reduced).first(std::min(count, batch_size));
  print("reduced, one at a time", alone(some));
  Evaluations last;
  for (const sim::reduced::ChainKernel* kernel : sim::reduced::supported_kernels()) {
    last = together(reduced, kernel);
    print("reduced, batches of " + std::to_string(batch_size) + ", " + kernel->instructions, last);
  }
  std::optional<Evaluations> mujoco;
  if (sim::mujoco::is_built_in()) {
    mujoco = alone(some, in_mujoco(sim::mujoco::Integrator::implicit));
    print("MuJoCo, implicit integrator", *mujoco);
    print("MuJoCo, Euler", alone(some, in_mujoco(sim::mujoco::Integrator::euler)));
  } else {
    std::puts("  MuJoCo is not built in (libmujoco-dev)");
  }
  std::printf("two cores against one: %.2f\n", gain_of_two_cores(some));
  print_agreement("reduced", ode.distances, last.distances);
  if (mujoco) {
    print_agreement("MuJoCo", ode.distances, mujoco->distances);
  }
}

/// The shipped gaits: does a resting tail help in each engine?
void print_shipped_gaits() {
  std::puts("distance in m    uniform  tail at rest  gain");
  const auto print = [](const std::string& name, sim::PhysicsEngine engine, const MakeWorld& make_world) {
    std::vector<sim::Scenario> gaits{read_gait("uniform"), read_gait("tail_fixed")};
    const std::vector<double> distances = alone(with_engine(std::move(gaits), engine), make_world).distances;
    std::printf("  %-16s %6.3f  %12.3f  %.3f\n", name.c_str(), distances[0], distances[1], distances[1] / distances[0]);
  };
  print("ODE", sim::PhysicsEngine::ode, nullptr);
  print("reduced", sim::PhysicsEngine::reduced, nullptr);
  if (sim::mujoco::is_built_in()) {
    print("MuJoCo, implicit", sim::PhysicsEngine::mujoco, in_mujoco(sim::mujoco::Integrator::implicit));
    print("MuJoCo, Euler", sim::PhysicsEngine::mujoco, in_mujoco(sim::mujoco::Integrator::euler));
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::optional<std::size_t> count = argc > 1 ? parse_whole<std::size_t>(argv[1]) : 200;
    if (!count || *count < 3 || argc > 2) {
      std::fprintf(stderr, "bench_reduced: expected a number of candidates, at least 3\n");
      return 2;
    }
    run(*count);
    print_shipped_gaits();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_reduced: %s\n", error.what());
    return 2;
  }
  return 0;
}
