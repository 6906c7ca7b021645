#include "tools/proleg/document/telemetry_row.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "sim/record/recorded_run.hpp"
#include "sim/robot/attached_sensor.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::tools {
namespace {

/// The nearest raw value; beyond the range of int32 the last raw value of the range.
std::int32_t rounded(double value) {
  if (!std::isfinite(value)) {
    return host::no_value;
  }
  constexpr double greatest = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::lround(std::clamp(value, -greatest, greatest)));
}

constexpr double unit_quaternion = 1 << 30;
constexpr std::size_t pose_values = 7;
/// Step of a quantity of an attached sensor, in its unit.
constexpr double sensor_step = 1e-3;
constexpr double raw_per_radian = (1 << 30) / (std::numbers::pi / 2);

}  // namespace

double value_of_step(Unit unit) {
  const UnitScale scale = scale_of(unit);
  return static_cast<double>(scale.denominator) / static_cast<double>(scale.numerator);
}

void append_pose(const sim::Pose& pose, std::vector<std::int32_t>& row) {
  for (const double metres : {pose.position.x(), pose.position.y(), pose.position.z()}) {
    row.push_back(rounded(metres * 1e6));
  }
  const Eigen::Quaterniond& turn = pose.orientation;
  for (const double part : {turn.w(), turn.x(), turn.y(), turn.z()}) {
    row.push_back(rounded(part * unit_quaternion));
  }
}

std::int32_t raw_angle(double angle) { return rounded(angle * raw_per_radian); }

std::vector<host::Signal> signals_of(const sim::Scenario& scenario) {
  using Of = host::SignalOf;
  const std::size_t joints = scenario.robot.joints.size();
  const std::size_t links = scenario.robot.links.size();
  std::vector<host::Signal> signals{{"setpoint", "deg", value_of_step(Unit::degree), joints, Of::joint},
                                    {"angle", "deg", value_of_step(Unit::degree), joints, Of::joint},
                                    {"pulse", "us", 1.0 / 12.0, joints, Of::joint},
                                    {"current", "mA", 1.0, joints, Of::joint},
                                    {"torque", "mNm", 1.0, joints, Of::joint},
                                    {"contact", "", 1.0, links, Of::link},
                                    {"force", "mN", 1.0, links, Of::link},
                                    {"head", "", 1.0, pose_values, Of::robot}};
  if (const std::size_t objects = scenario.environment.moving_objects.size(); objects > 0) {
    signals.push_back({"object", "", 1.0, pose_values * objects, Of::robot});
  }
  for (const unsigned slot : sim::used_slots(scenario)) {
    const Slot& used = scenario.kernel.slots[slot];
    for (const InternalValue& value : used.algorithm->declaration().internal_values) {
      signals.push_back({std::to_string(slot + 1) + '/' + std::string(value.name), sim::shown_unit(value.unit),
                         value_of_step(value.unit), used.group.size(), Of::joint});
    }
  }
  for (const sim::AttachedSensor& sensor : scenario.robot.sensors) {
    for (const sim::SensorQuantity& quantity : sim::quantities_of(sensor.kind)) {
      signals.push_back({"sensor/" + sensor.name + '/' + std::string(quantity.name), std::string(quantity.unit),
                         sensor_step, 1, Of::robot});
    }
  }
  return signals;
}

namespace {

/// Appends the values of sensors. Runs of real robots, and recordings of older programs, have no values.
void fill_sensors(std::span<const double> values, const sim::RobotModel& robot, std::vector<std::int32_t>& row) {
  std::size_t first = 0;
  for (const sim::AttachedSensor& sensor : robot.sensors) {
    const std::size_t channels = sim::channels_of(sensor).size();
    const bool is_known = first + channels <= values.size();
    for (std::size_t quantity = 0; quantity < sim::quantities_of(sensor.kind).size(); ++quantity) {
      row.push_back(
          is_known ? rounded(sim::quantity_of(sensor.kind, quantity, values.subspan(first, channels)) / sensor_step)
                   : host::no_value);
    }
    first += channels;
  }
}

}  // namespace

void fill_row(const sim::TickSample& sample, const sim::Scenario& scenario, std::vector<std::int32_t>& row) {
  row.assign(sample.setpoints.begin(), sample.setpoints.end());
  for (const double angle : sample.joint_angles) {
    row.push_back(raw_angle(angle));
  }
  row.insert(row.end(), sample.servo_commands.begin(), sample.servo_commands.end());
  for (const double current : sample.servo_currents) {
    row.push_back(rounded(current));
  }
  for (const double torque : sample.motor_torques) {
    row.push_back(rounded(torque * 1e3));
  }
  row.insert(row.end(), sample.latched_contacts.begin(), sample.latched_contacts.end());
  for (const double force : sample.contact_forces) {
    row.push_back(rounded(force * 1e3));
  }
  append_pose(sample.link_poses.front(), row);
  const std::size_t objects = scenario.environment.moving_objects.size();
  for (std::size_t object = 0; object < objects; ++object) {
    if (object < sample.object_poses.size()) {
      append_pose(sample.object_poses[object], row);
    } else {
      row.insert(row.end(), pose_values, host::no_value);  // the pose is not simulated
    }
  }
  // A recording has all values of one joint one after the other, a signal has one value of all joints.
  std::size_t begin = 0;
  for (const unsigned slot : sim::used_slots(scenario)) {
    const Slot& used = scenario.kernel.slots[slot];
    const std::size_t values = used.algorithm->declaration().internal_values.size();
    const std::size_t joints = used.group.size();
    for (std::size_t value = 0; value < values; ++value) {
      for (std::size_t joint = 0; joint < joints; ++joint) {
        row.push_back(sample.internal_values[begin + joint * values + value]);
      }
    }
    begin += values * joints;
  }
  fill_sensors(sample.sensor_values, scenario.robot, row);
}

void fill_row(const sim::RecordedTick& tick, const sim::Scenario& scenario, std::vector<std::int32_t>& row) {
  fill_row({.tick = tick.tick,
            .latched_contacts = tick.latched_contacts,
            .setpoints = tick.setpoints,
            .internal_values = tick.internal_values,
            .servo_pulses = {},
            .servo_commands = tick.servo_commands,
            .link_poses = tick.link_poses,
            .joint_angles = tick.joint_angles,
            .motor_torques = tick.motor_torques,
            .servo_currents = tick.servo_currents,
            .contact_forces = tick.contact_forces,
            .lost = {},
            .moves = {},
            .object_poses = tick.object_poses,
            .sensor_values = tick.sensor_values},
           scenario, row);
}

}  // namespace proleg::tools
