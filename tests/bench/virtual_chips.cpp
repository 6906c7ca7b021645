// Prints how fast robots of virtual chips run, against real time and against one thread, and whether all give the same.
// An argument is the simulated time in seconds; 5 without one.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>

#include "shared/computer/hash/sha256.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/mcu/module/virtual_module.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

struct Run {
  double seconds = 0.0;  ///< by the clock, from SYNC 0 on
  std::string hashes;    ///< of set-points, pulses and the end of each frame
};

Run run(const Scenario& scenario, const FirmwareImage& image, unsigned threads, std::uint32_t ticks) {
  ValueHash frames;
  HardwareOptions options;
  options.threads = threads;
  options.make_module = [&](const ModuleParts& parts) {
    return std::make_unique<VirtualModule>(parts, image, VirtualModuleOptions{});
  };
  options.on_frame = [&](const Transmission& sent) {
    frames.append(static_cast<std::int32_t>(sent.end % 1'000'000'000));
    frames.append(sent.frame.identifier);
  };
  HardwareLoop loop(scenario, std::move(options));
  const auto start = std::chrono::steady_clock::now();
  while (loop.tick() < ticks) {
    loop.advance();
  }
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  return {time.count(), loop.setpoint_hash().hex() + loop.servo_hash().hex() + frames.hex()};
}

void print_figures(double simulated_s) {
  const FirmwareImage image(PROLEG_IMAGE);
  DiskFiles files;
  std::printf("chips  threads  x real time  x one thread  result\n");
  for (const char* const name : {"travelling_wave/coupled", "long_chain/twenty"}) {
    const Scenario scenario = read_scenario(source_path("/sim/scenarios/") + name + ".simulation.xml", files);
    const auto ticks = static_cast<std::uint32_t>(simulated_s * 1e6 / scenario.kernel.tick_period_us);
    const double length_s = ticks * (scenario.kernel.tick_period_us * 1e-6);
    const Run alone = run(scenario, image, 1, ticks);
    for (unsigned threads = 1; threads <= 2; ++threads) {
      const Run measured = threads == 1 ? alone : run(scenario, image, threads, ticks);
      std::printf("%5zu  %7u  %11.1f  %12.2f  %s\n", scenario.modules.size(), threads, length_s / measured.seconds,
                  alone.seconds / measured.seconds, measured.hashes == alone.hashes ? "the same" : "DIFFERS");
    }
  }
}

}  // namespace
}  // namespace proleg::sim

int main(int argc, char** argv) {
  try {
    proleg::sim::print_figures(argc > 1 ? std::atof(argv[1]) : 5.0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
