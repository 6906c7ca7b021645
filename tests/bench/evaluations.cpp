// Evaluations per second on one core: the shipped caterpillar with the default workloads of optimisers of robots.
// Displacement and contacts are printed because a robot that lies still, or one that flies, takes a different time.
//
//   bench_evaluations [options of Google Benchmark]

#include <benchmark/benchmark.h>

#include <cstdio>
#include <exception>
#include <string>

#include "sim/scenario/reader.hpp"
#include "tests/bench/evaluation.hpp"
#include "tests/support/files.hpp"

namespace {

using namespace proleg;

void time_evaluations(benchmark::State& state, const sim::Scenario& scenario, const bench::Workload& workload) {
  bench::Evaluation evaluation;
  for (auto _ : state) {
    evaluation = bench::evaluate(scenario, workload);
  }
  const auto evaluations = static_cast<double>(state.iterations());
  // Rates are by processor time, so other programs do not affect them.
  state.counters["evaluations"] = benchmark::Counter(evaluations, benchmark::Counter::kIsRate);
  state.counters["x_real_time"] = benchmark::Counter(evaluations * workload.seconds(), benchmark::Counter::kIsRate);
  state.counters["displacement_m"] = evaluation.displacement;
  state.counters["contacts"] = evaluation.mean_contacts;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    sim::DiskFiles files;
    const sim::Scenario scenario =
        sim::read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
    for (const bench::Workload& workload : bench::workloads) {
      benchmark::RegisterBenchmark(std::string(workload.name).c_str(),
                                   [&workload, changed = bench::with_workload(scenario, workload)](
                                       benchmark::State& state) { time_evaluations(state, changed, workload); })
          ->Unit(benchmark::kMillisecond)
          ->MinTime(2.0);
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
      return 2;
    }
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_evaluations: %s\n", error.what());
    return 2;
  }
  return 0;
}
