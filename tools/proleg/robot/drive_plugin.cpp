#include "tools/proleg/robot/drive_plugin.hpp"

#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "tools/proleg/common/interrupt.hpp"
#include "tools/proleg/robot/robot_control_drive.hpp"

namespace proleg::tools {

int drive_by_plugin(const ScenarioOptions& options, const ScenarioRun& run) {
  if (options.record) {
    throw InputError("--record", 0, "a robot behind a plug-in", "a robot of modules: only those are recorded");
  }
  catch_interrupts();
  RobotControlDrive drive;
  drive.ticks = run.ticks;
  drive.must_stop = [] { return interrupted(); };
  drive.show = [](const std::string& line) { std::cerr << "proleg drive: " << line << '\n'; };
  host::DriveResult result;
  try {
    result = drive_robot_control(run.scenario, drive);
  } catch (const host::RobotFileError& error) {
    throw BadInput(error.what());
  }
  const double seconds = result.gait_ticks * (run.scenario.kernel.tick_period_us * 1e-6);
  if (options.json) {
    std::cout << Json{{"scenario", options.file},
                      {"plugin", run.scenario.robot_control->plugin},
                      {"ticks", result.gait_ticks},
                      {"driven_s", seconds},
                      {"late_ticks", result.late_ticks},
                      {"max_delay_us", result.max_delay_us},
                      {"max_difference_deg", result.max_difference_deg},
                      {"failure", result.failure}}
                     .text()
              << '\n';
  } else {
    std::printf("driven            %.2f s, %u ticks, by plug-in %s\n", seconds, result.gait_ticks,
                run.scenario.robot_control->plugin.c_str());
    std::printf("late ticks        %u, at most %.1f ms\n", result.late_ticks,
                static_cast<double>(result.max_delay_us) / 1'000.0);
    std::printf("measured angles   at most %.1f degrees from the set-points\n", result.max_difference_deg);
  }
  if (result.failure) {
    throw std::runtime_error(*result.failure);
  }
  return exit_success;
}

}  // namespace proleg::tools
