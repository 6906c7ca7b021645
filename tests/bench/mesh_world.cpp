// How many times faster than real time a scenario runs, in processor time, so that other programs do not count.
//   bench_mesh_world sim/scenarios/robots/mesh_world/mesh_world.simulation.xml [SECONDS]

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>

#include "sim/loop/simulation.hpp"
#include "sim/scenario/reader.hpp"

int main(int argc, char** argv) {
  using namespace proleg::sim;
  if (argc < 2) {
    std::fputs("bench_mesh_world: found no scenario, expected SCENARIO [SECONDS]\n", stderr);
    return 2;
  }
  try {
    DiskFiles files;
    Scenario scenario = read_scenario(argv[1], files);
    scenario.duration_s = argc > 2 ? std::strtod(argv[2], nullptr) : scenario.duration_s;
    Simulation simulation(scenario);
    const std::clock_t start = std::clock();
    while (simulation.time_s() < scenario.duration_s - 1e-9) {
      simulation.advance();
    }
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    std::printf(
        "%zu links, %.0f s: %.2f s of processor time, real-time factor %.1f (wanted: at least 5), %.1f contacts, "
        "displacement %.3f m\n",
        scenario.robot.links.size(), scenario.duration_s, seconds, scenario.duration_s / seconds,
        simulation.plant().mean_contacts(), simulation.plant().displacement());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_mesh_world: %s\n", error.what());
    return 2;
  }
}
