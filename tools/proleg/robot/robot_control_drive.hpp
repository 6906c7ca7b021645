#pragma once

// Drives a robot behind a plug-in from the same scenario that `proleg simulate` takes. The kernels run on this
// computer, because such a robot has no modules with a core of their own. `proleg drive FILE --robot-control` calls it.

#include <cstdint>
#include <functional>
#include <string>

#include "host/robot_control/gait_driver.hpp"
#include "host/robot_control/robot_control.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/scenario_run.hpp"

namespace proleg {

/// What the plug-in learns of the scenario's robot. Throws InputError if the robot's file has no <robot_control>.
[[nodiscard]] host::RobotControlSetup robot_control_setup(const sim::Scenario& scenario);

/// The limits and the greatest speed of the scenario's joints.
[[nodiscard]] host::DriveLimits drive_limits(const sim::Scenario& scenario);

/// Finds and loads the plug-in that the robot's file names. Throws InputError and host::RobotFileError.
[[nodiscard]] host::Plugin robot_control_plugin(const sim::Scenario& scenario);

struct RobotControlDrive {
  std::uint32_t ticks = 0;                         ///< of the gait; 0: until must_stop
  std::function<bool()> must_stop{};               ///< asked before each tick; true ends the run with a ramp down
  std::function<void(const std::string&)> show{};  ///< lines for the user; called from several threads, never at once
  host::GaitDriver::Observer observer{};           ///< after each tick of the gait
};

/// Connects, ramps in, plays the gait, ramps down and takes the power from the servos. Nothing moves before all parts
/// of the robot have answered. Throws InputError and host::RobotFileError (bad input), host::RobotControlError (plug-in
/// or robot; nothing has moved). A failure in the run is in the result, and the robot has been ramped down as far as it
/// follows.
[[nodiscard]] host::DriveResult drive_robot_control(const sim::Scenario& scenario, const RobotControlDrive& drive);

/// Drives with a plug-in and a clock that tests provide.
[[nodiscard]] host::DriveResult drive_robot_control(const sim::Scenario& scenario, const RobotControlDrive& drive,
                                                    const host::Plugin& plugin, host::Clock& clock);

}  // namespace proleg

namespace proleg::tools {

/// Drives a robot without modules, by the plug-in that its file names. Returns the exit status.
int drive_by_plugin(const ScenarioOptions& options, const ScenarioRun& run);

}  // namespace proleg::tools
