// The same robot, environment and servo pulses in our world (Open Dynamics Engine) and in MuJoCo: what they cost, and
// where the robot gets to. Two models of contact never agree to the centimetre on a gait that slips; the gain of a
// resting tail should survive the change. The worlds take turns in one process, so that their ratios hold on any
// machine.
//
//   bench_mujoco [REPETITIONS]

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/scenario/reader.hpp"
#include "tests/bench/mujoco/mjcf.hpp"
#include "tests/bench/mujoco/mujoco_evaluation.hpp"
#include "tests/support/files.hpp"

namespace {

using namespace proleg;
using namespace proleg::bench;

/// The first is ours, the one that the others are compared with.
constexpr std::array<const char*, 3> world_names{"ODE", "MuJoCo, implicit", "MuJoCo, Euler"};
using Displacements = std::array<double, world_names.size()>;

/// Of processor time, so that other programs do not count.
double seconds_of(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

sim::Scenario read(const std::string& gait, const Workload& workload) {
  sim::DiskFiles files;
  return with_workload(
      sim::read_scenario(source_path("/sim/scenarios/travelling_wave/") + gait + ".simulation.xml", files), workload);
}

Displacements compare(const std::string& gait, const Workload& workload, int repetitions) {
  const sim::Scenario scenario = read(gait, workload);
  const auto compile = [&](MujocoIntegrator integrator) {
    return compile_mjcf(write_mjcf(scenario.robot, scenario.environment, scenario.step_s, integrator));
  };
  const MujocoModel implicit = compile(MujocoIntegrator::implicit);
  const MujocoModel euler = compile(MujocoIntegrator::euler);
  const std::array<std::function<Evaluation()>, world_names.size()> evaluate_in{
      [&] { return evaluate(scenario, workload); },
      [&] { return evaluate_in_mujoco(scenario, workload, *implicit); },
      [&] { return evaluate_in_mujoco(scenario, workload, *euler); },
  };
  std::array<Evaluation, world_names.size()> evaluations;
  std::array<std::vector<double>, world_names.size()> times;
  std::array<std::vector<double>, world_names.size()> ratios;
  for (int i = 0; i <= repetitions; ++i) {
    for (std::size_t world = 0; world < world_names.size(); ++world) {
      const double time = seconds_of([&] { evaluations[world] = evaluate_in[world](); });
      if (i > 0) {  // the first round warms up
        times[world].push_back(time);
        ratios[world].push_back(times[0].back() / time);
      }
    }
  }
  Displacements displacements{};
  for (std::size_t world = 0; world < world_names.size(); ++world) {
    const Evaluation& evaluation = evaluations[world];
    if (evaluation.servo_hash != evaluations[0].servo_hash) {
      throw std::runtime_error("the servos of " + gait + " did not get the same pulses in all worlds");
    }
    std::printf("%-9s %-11s %-17s %13.3f %9.2f %14.2f %7.2f\n", std::string(workload.name).c_str(), gait.c_str(),
                world_names[world], evaluation.displacement, evaluation.mean_contacts, 1.0 / median(times[world]),
                median(ratios[world]));
    displacements[world] = evaluation.displacement;
  }
  return displacements;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int repetitions = std::max(argc > 1 ? std::atoi(argv[1]) : 5, 1);
    std::printf("MuJoCo %s, %d repetitions, medians of processor time\n", mj_versionString(), repetitions);
    std::puts("workload  gait        world            displacement m  contacts  evaluations/s   x ODE");
    for (const Workload& workload : workloads) {
      const Displacements uniform = compare("uniform", workload, repetitions);
      const Displacements tail_fixed = compare("tail_fixed", workload, repetitions);
      std::printf("%-9s gain of the resting tail:", std::string(workload.name).c_str());
      for (std::size_t world = 0; world < world_names.size(); ++world) {
        std::printf(" %s %.3f%s", world_names[world], tail_fixed[world] / uniform[world],
                    world + 1 < world_names.size() ? ";" : "\n\n");
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_mujoco: %s\n", error.what());
    return 2;
  }
  return 0;
}
