// Evaluations per second and core of both physics engines, with kernels, sensors and measures, and how well their
// results agree. All figures are of one run and by processor time, so other programs do not affect the ratios.
//
//   bench_reduced [CANDIDATES]   compared with ODE; by default 200

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/bench/candidates.hpp"
#include "tests/bench/engine_agreement.hpp"
#include "tests/support/files.hpp"

namespace {

using namespace proleg;

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

template <typename Run>
Evaluations timed(const Run& run) {
  const double start = processor_time();
  Evaluations result{run()};
  result.per_second = static_cast<double>(result.distances.size()) / (processor_time() - start);
  return result;
}

void print_agreement(const std::vector<double>& ode, const std::vector<double>& reduced) {
  const bench::EngineAgreement agreement = bench::agreement_of(ode, reduced);
  const auto difference_mm = [&](double share) { return 1000.0 * bench::quantile(agreement.differences, share); };
  std::printf(
      "distances of %zu candidates (seed %llu): rank correlation %.4f; difference: median %.1f mm or %.2f %%, "
      "90 %% within %.1f mm, worst %.0f mm\n",
      ode.size(), static_cast<unsigned long long>(bench::candidate_seed), agreement.rank_correlation,
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

void run(std::size_t count) {
  sim::DiskFiles files;
  const sim::Scenario scenario =
      sim::read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
  const std::vector<sim::Scenario> candidates = bench::candidates(scenario, count, bench::candidate_seed);
  const std::vector<sim::Scenario> reduced = bench::with_engine(candidates, sim::PhysicsEngine::reduced);
  std::printf("evaluations of %.0f s in a second of one core\n", scenario.duration_s);
  const std::vector<sim::Scenario> in_ode = bench::with_engine(candidates, sim::PhysicsEngine::ode);
  const Evaluations ode = timed([&] { return bench::distances_alone(in_ode); });
  std::printf("  %-34s %6.2f\n", "ODE", ode.per_second);
  const auto print = [&](const std::string& name, const Evaluations& result) {
    std::printf("  %-34s %6.1f  %5.1f x ODE\n", name.c_str(), result.per_second, result.per_second / ode.per_second);
  };
  const std::span<const sim::Scenario> some = std::span(reduced).first(std::min(count, bench::batch_size));
  print("reduced, one at a time", timed([&] { return bench::distances_alone(some); }));
  Evaluations last;
  for (const sim::reduced::ChainKernel* kernel : sim::reduced::supported_kernels()) {
    last = timed([&] { return bench::distances_together(reduced, kernel); });
    print("reduced, batches of " + std::to_string(bench::batch_size) + ", " + kernel->instructions, last);
  }
  std::printf("two cores against one: %.2f\n", gain_of_two_cores(some));
  print_agreement(ode.distances, last.distances);
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
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_reduced: %s\n", error.what());
    return 2;
  }
  return 0;
}
