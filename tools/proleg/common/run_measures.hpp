#pragma once

// The output of the measures (docs/gait-measures.md) and hashes of a run.

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/measure/gait_meter.hpp"
#include "sim/measure/measure.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/sensor/attached_sensors.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {

struct RunMeasures {
  sim::MeasureValues values;
  std::vector<double> link_duty_factors;   ///< duty factors of the links, from the head
  std::vector<sim::ServoTracking> servos;  ///< tracking by joint, from the head
};

[[nodiscard]] RunMeasures measures_of(const sim::GaitMeter& meter);

/// An object of all measures by name; null if the run does not define a measure.
[[nodiscard]] Json measures_object(const sim::MeasureValues& values);

/// An array with the tracking of each joint's servo, from the head: joint, rms_error_deg, max_error_deg,
/// at_speed_limit, at_torque_limit; null if the run does not define a value.
[[nodiscard]] Json servos_array(const RunMeasures& measures, const sim::RobotModel& robot);

/// An array with the values of the sensors in the robot's file: sensor, type, quantity, unit, least, greatest, mean.
[[nodiscard]] Json sensors_array(const std::vector<sim::SensorSummary>& sensors);

/// Prints the values of the sensors on standard output, one quantity in each line.
void print_sensors(const std::vector<sim::SensorSummary>& sensors);

/// What keeps servos from following the gait, if any is at a limit for more than a fifth of the time and misses its
/// set-points by more than 5 degrees (root mean square); else an empty text. servos: by joint, from the head.
[[nodiscard]] std::string servo_problem(std::span<const sim::ServoTracking> servos, const sim::RobotModel& robot);
/// Prints a warning with servo_problem() and the largest difference. program: begin of the line.
void print_warning_on_servos(const std::string& program, const RunMeasures& measures, const sim::RobotModel& robot);

/// Adds the option --measures: print all measures instead of the most important ones.
void add_measures_option(CommandLine& command_line, bool& all);

/// Prints the hashes of a run; world: nothing if the engine has none.
void print_hashes(const std::string& setpoints, const std::string& servos, const std::optional<std::string>& world,
                  const std::string& motion);

/// Prints measures that the run defines on standard output, one in each line: all, or the six that say most.
void print_measures(const sim::MeasureValues& values, bool all);

/// Adds least, greatest and mean value of the sensors' quantities to the results of a recording.
void append_sensors(const std::vector<sim::SensorSummary>& sensors,
                    std::vector<std::pair<std::string, std::string>>& results);

/// Adds the measures that the run defines, and the duty factors of the links, to the results of a recording.
void append_results(const RunMeasures& measures, const sim::RobotModel& robot,
                    std::vector<std::pair<std::string, std::string>>& results);

}  // namespace proleg::tools
