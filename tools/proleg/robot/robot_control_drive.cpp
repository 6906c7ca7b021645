#include "tools/proleg/robot/robot_control_drive.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/actuation_module.hpp"
#include "sim/loop/gait.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg {
namespace {

const sim::RobotControlEntry& entry_of(const sim::Scenario& scenario) {
  if (!scenario.robot_control) {
    throw InputError(scenario.path, 0, "a robot without <robot_control> in its file",
                     "one that names the plug-in (docs/robot-control.md), or a robot with modules and --bus");
  }
  return *scenario.robot_control;
}

double degrees(std::int32_t angle) { return angle * 90.0 / (1 << 30); }

bool senses_contacts(const sim::Scenario& scenario) {
  return std::ranges::any_of(scenario.kernel.slots, [](const auto& slot) {
    return slot.algorithm != nullptr && slot.algorithm->senses_contacts();
  });
}

/// The gait of a scenario in memory, with its changes.
class ScenarioGait final : public host::SetpointSource {
 public:
  /// scenario: must outlive the gait.
  explicit ScenarioGait(const sim::Scenario& scenario) : gait_(scenario) {}

  [[nodiscard]] std::span<const std::int32_t> setpoints() const override { return gait_.chain().setpoints(); }
  void advance(std::span<const std::uint8_t> contacts) override {
    gait_.apply_due_changes();
    gait_.advance(contacts);
  }

 private:
  sim::Gait gait_;
};

}  // namespace

host::RobotControlSetup robot_control_setup(const sim::Scenario& scenario) {
  const sim::RobotControlEntry& entry = entry_of(scenario);
  host::RobotControlSetup setup;
  setup.file = entry.file;
  setup.line = entry.line;
  setup.tick_us = scenario.kernel.tick_period_us;
  for (std::size_t joint = 0; joint < scenario.robot.joints.size(); ++joint) {
    const AngleLimits& limits = scenario.joint_limits[joint];
    setup.joints.push_back({scenario.robot.joints[joint].name, degrees(limits.lower), degrees(limits.upper),
                            scenario.robot.joints[joint].max_speed * 180.0 / std::numbers::pi});
  }
  for (const auto& parameter : entry.parameters) {
    setup.parameters.push_back({parameter.name, parameter.value, parameter.joint.value_or(PROLEG_ALL_JOINTS),
                                static_cast<std::uint32_t>(parameter.line)});
  }
  return setup;
}

host::DriveLimits drive_limits(const sim::Scenario& scenario) {
  host::DriveLimits limits;
  for (const AngleLimits& joint : scenario.joint_limits) {
    limits.lower.push_back(joint.lower);
    limits.upper.push_back(joint.upper);
  }
  limits.command_speed = scenario.robot.servo.command_speed;
  return limits;
}

host::Plugin robot_control_plugin(const sim::Scenario& scenario) {
  const sim::RobotControlEntry& entry = entry_of(scenario);
  try {
    return host::load_plugin(host::find_plugin(entry.plugin, entry.folder, host::plugin_folders()));
  } catch (const host::RobotControlError& error) {
    throw host::RobotFileError(entry.file + ":" + std::to_string(entry.line) + ": " + error.what());
  }
}

host::DriveResult drive_robot_control(const sim::Scenario& scenario, const RobotControlDrive& drive) {
  host::SteadyClock clock;
  return drive_robot_control(scenario, drive, robot_control_plugin(scenario), clock);
}

host::DriveResult drive_robot_control(const sim::Scenario& scenario, const RobotControlDrive& drive,
                                      const host::Plugin& plugin, host::Clock& clock) {
  std::mutex mutex;
  const auto show = [&](const std::string& text) {
    const std::lock_guard lock(mutex);
    if (drive.show) {
      drive.show(text);
    }
  };
  host::RobotControl control(plugin, robot_control_setup(scenario), show);
  show("the kernels of the gait run on this computer; the robot has no modules with a core of their own");
  if (senses_contacts(scenario) && control.description().sensor_modules == 0) {
    show("the gait reads touch sensors, and plug-in " + in_quotes(control.name()) +
         " has none: all read 'not pressed'");
  }
  ScenarioGait gait(scenario);
  host::GaitDriver driver(control, gait, drive_limits(scenario), drive.ticks, drive.observer);
  return host::drive(driver, clock, drive.must_stop);
}

}  // namespace proleg

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
