// Evaluations per second and core of the physics engines, with kernels, sensors and measures, and how well their
// results agree: for the shipped robot of pitch joints, and for one whose joints alternate between pitch and yaw. All
// figures are of one run and by processor time, so other programs do not affect the ratios. MuJoCo has a row for each
// of two integrators, if it is built in.
//
//   bench_reduced [CANDIDATES]            compared with ODE; by default 200
//   bench_reduced --batches CANDIDATES    the reduced engine alone: evaluations in a second of one core

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/mujoco/mujoco_world.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/bench/candidates.hpp"
#include "tests/bench/engine_agreement.hpp"
#include "tests/support/files.hpp"

namespace {

using namespace proleg;

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

class Evaluations {
 public:
  /// What run() gives, the distances of some candidates; and its time counts.
  template <typename Run>
  std::vector<double> timed(const Run& run) {
    const double start = processor_time();
    std::vector<double> result = run();
    seconds_ += processor_time() - start;
    count_ += result.size();
    return result;
  }
  void keep(const std::vector<double>& more) { distances_.insert(distances_.end(), more.begin(), more.end()); }
  [[nodiscard]] const std::vector<double>& distances() const { return distances_; }  ///< m
  [[nodiscard]] double per_second() const { return static_cast<double>(count_) / seconds_; }

 private:
  std::vector<double> distances_;
  std::size_t count_ = 0;
  double seconds_ = 0.0;
};

bench::MakeWorld in_mujoco(sim::mujoco::Integrator integrator) {
  return [integrator](const sim::Scenario& scenario) {
    return sim::mujoco::make_mujoco_world(scenario.robot, scenario.environment, scenario.step_s, scenario.path,
                                          integrator);
  };
}

/// others: as many distances as the first of ODE's, or all of them.
void print_agreement(const char* name, std::span<const double> all_of_ode, const std::vector<double>& others) {
  const std::vector<double> ode(all_of_ode.begin(), all_of_ode.begin() + static_cast<std::ptrdiff_t>(others.size()));
  const bench::EngineAgreement agreement = bench::agreement_of(ode, others);
  const auto difference_mm = [&](double share) { return 1000.0 * bench::quantile(agreement.differences, share); };
  std::printf(
      "%s against ODE, distances of %zu candidates (seed %llu): rank correlation %.4f; difference: median %.1f mm or "
      "%.2f %%, 90 %% within %.1f mm, worst %.0f mm\n",
      name, ode.size(), static_cast<unsigned long long>(bench::candidate_seed), agreement.rank_correlation,
      difference_mm(0.5), 100.0 * bench::quantile(agreement.relative, 0.5), difference_mm(0.9), difference_mm(1.0));
}

/// Rate of two threads with a batch each against one, by wall-clock time.
double gain_of_two_cores(std::span<const sim::Scenario> candidates) {
  const auto wall_time = [] {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
  };
  const double start = wall_time();
  static_cast<void>(bench::distances_together(candidates));
  const double one = wall_time() - start;
  std::thread other([&] { static_cast<void>(bench::distances_together(candidates)); });
  static_cast<void>(bench::distances_together(candidates));
  other.join();
  return 2.0 * one / (wall_time() - start - one);
}

/// Every second joint turns about z.
sim::Scenario with_yaw_joints(sim::Scenario scenario) {
  for (std::size_t joint = 1; joint < scenario.robot.joints.size(); joint += 2) {
    scenario.robot.joints[joint].axis = Eigen::Vector3d::UnitZ();
  }
  return scenario;
}

void compare(const sim::Scenario& scenario, const char* robot, std::size_t count) {
  const std::vector<sim::Scenario> candidates = bench::candidates(scenario, count, bench::candidate_seed);
  const std::vector<sim::Scenario> all_reduced = bench::with_engine(candidates, sim::PhysicsEngine::reduced);
  const std::vector<sim::Scenario> all_in_ode = bench::with_engine(candidates, sim::PhysicsEngine::ode);
  const std::span<const sim::Scenario> reduced(all_reduced);
  const std::span<const sim::Scenario> in_ode(all_in_ode);
  const std::size_t some = std::min(count, bench::batch_size);

  const std::vector<const sim::reduced::ChainKernel*> kernels = sim::reduced::supported_kernels();
  Evaluations ode;
  std::vector<Evaluations> together(kernels.size());
  Evaluations alone;
  Evaluations mujoco;
  Evaluations mujoco_euler;
  // The speed of a machine drifts, so the engines take turns, and the fast ones have several.
  constexpr std::size_t turns = 4;
  for (std::size_t first = 0; first < count; first += bench::batch_size) {
    const std::size_t size = std::min(bench::batch_size, count - first);
    const bool is_full = size == some;
    for (std::size_t turn = 0; turn < turns; ++turn) {
      const std::size_t from = first + turn * size / turns;
      const std::size_t end = first + (turn + 1) * size / turns;
      ode.keep(ode.timed([&] { return bench::distances_alone(in_ode.subspan(from, end - from)); }));
      for (std::size_t i = 0; i < kernels.size() && is_full; ++i) {
        together[i].timed([&] { return bench::distances_together(reduced.subspan(first, size), kernels[i]); });
      }
    }
    together.back().keep(bench::distances_together(reduced.subspan(first, size), kernels.back()));
    if (first > 0) {
      continue;
    }
    alone.timed([&] { return bench::distances_alone(reduced.first(size)); });
    if (sim::mujoco::is_built_in()) {
      const auto run = [&](sim::mujoco::Integrator integrator) {
        return bench::distances_alone(reduced.first(size), in_mujoco(integrator));
      };
      mujoco.keep(mujoco.timed([&] { return run(sim::mujoco::Integrator::implicit); }));
      mujoco_euler.timed([&] { return run(sim::mujoco::Integrator::euler); });
    }
  }

  std::printf("%s: evaluations of %.0f s in a second of one core\n", robot, scenario.duration_s);
  std::printf("  %-34s %6.2f\n", "ODE", ode.per_second());
  const auto print = [&](const std::string& name, const Evaluations& result) {
    std::printf("  %-34s %6.1f  %5.2f x ODE\n", name.c_str(), result.per_second(),
                result.per_second() / ode.per_second());
  };
  print("reduced, one at a time", alone);
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    print("reduced, batches of " + std::to_string(bench::batch_size) + ", " + kernels[i]->instructions, together[i]);
  }
  if (sim::mujoco::is_built_in()) {
    print("MuJoCo, implicit integrator", mujoco);
    print("MuJoCo, Euler", mujoco_euler);
  } else {
    std::puts("  MuJoCo is not built in (libmujoco-dev)");
  }
  std::printf("two cores against one: %.2f\n", gain_of_two_cores(reduced.first(some)));
  print_agreement("reduced engine", ode.distances(), together.back().distances());
  if (sim::mujoco::is_built_in()) {
    print_agreement("MuJoCo", ode.distances(), mujoco.distances());
  }
  // How far the result depends on the step, which is no fault of an engine.
  std::vector<sim::Scenario> finer(in_ode.begin(), in_ode.begin() + static_cast<std::ptrdiff_t>(some));
  for (sim::Scenario& candidate : finer) {
    candidate.step_s /= 2.0;
  }
  print_agreement("ODE with half the step", ode.distances(), bench::distances_alone(finer));
}

/// The fastest way of the reduced engine, in whole batches.
void print_batches(const sim::Scenario& scenario, std::size_t count) {
  const std::vector<sim::Scenario> candidates =
      bench::with_engine(bench::candidates(scenario, count, bench::candidate_seed), sim::PhysicsEngine::reduced);
  const std::span<const sim::Scenario> all(candidates);
  Evaluations evaluations;
  for (std::size_t first = 0; first < count; first += bench::batch_size) {
    evaluations.timed([&] {
      return bench::distances_together(all.subspan(first, std::min(bench::batch_size, count - first)),
                                       sim::reduced::supported_kernels().back());
    });
  }
  std::printf("%.2f\n", evaluations.per_second());
}

/// The shipped gaits: does a resting tail help in each engine?
void print_shipped_gaits() {
  std::puts("distance in m    uniform  tail at rest  gain");
  const auto print = [](const std::string& name, sim::PhysicsEngine engine, const bench::MakeWorld& make_world) {
    const std::vector<sim::Scenario> gaits =
        bench::with_engine({read_gait("uniform"), read_gait("tail_fixed")}, engine);
    const std::vector<double> distances = bench::distances_alone(gaits, make_world);
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
    const bool only_batches = argc > 1 && std::string_view(argv[1]) == "--batches";
    const int place = only_batches ? 2 : 1;
    const std::optional<std::size_t> count = argc > place ? parse_whole<std::size_t>(argv[place]) : 200;
    if (!count || *count < 3 || argc > place + 1) {
      std::fprintf(stderr, "bench_reduced: expected a number of candidates, at least 3\n");
      return 2;
    }
    const sim::Scenario scenario = read_gait("uniform");
    if (only_batches) {
      print_batches(scenario, *count);
      return 0;
    }
    compare(scenario, "pitch joints", *count);
    compare(with_yaw_joints(scenario), "pitch and yaw joints", *count);
    print_shipped_gaits();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_reduced: %s\n", error.what());
    return 2;
  }
  return 0;
}
