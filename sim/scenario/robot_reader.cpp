#include "sim/scenario/robot_reader.hpp"

#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/chain.hpp"
#include "sim/scenario/kinbody_reader.hpp"
#include "sim/scenario/module_reader.hpp"
#include "sim/scenario/plausibility.hpp"
#include "sim/scenario/robot_control_reader.hpp"
#include "sim/scenario/sensor_reader.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr Range gains{1e-3, 1e4, "1/s"};
constexpr Range servo_periods{0.1, 100.0, "ms"};
constexpr Range servo_latencies{0.0, 100.0, "ms"};

ServoModel read_servo(const XmlElement& element, double step_s) {
  element.allow({}, {"gain", "period", "commandspeed", "latency"});
  ServoModel servo;
  if (const auto gain = element.child("gain")) {
    servo.gain = read_quantity(*gain, gains);
    if (servo.gain * step_s > 1.0) {
      gain->refuse("a gain of " + number_text(servo.gain) + " 1/s with steps of " + number_text(step_s * 1e3) +
                       " ms, with which the servo overshoots in every step",
                   "at most " + number_text(1.0 / step_s) + " 1/s, or a smaller <stepWidth>");
    }
  }
  if (const auto period = element.child("period")) {
    servo.period_us = read_microseconds(*period, servo_periods);
  }
  if (const auto speed = element.child("commandspeed")) {
    servo.command_speed = static_cast<std::uint32_t>(read_whole(*speed, min_command_speed, max_command_speed));
  }
  if (const auto latency = element.child("latency")) {
    servo.latency_us = read_microseconds(*latency, servo_latencies);
  }
  return servo;
}

}  // namespace

RobotDescription read_robot(const XmlDocument& document, double step_s, SourceSet& sources,
                            std::vector<std::string>& remarks) {
  const XmlElement root = document.root("Robot");
  constexpr std::array<std::string_view, 6> extra_tags{"servo",          "module", "robot_control",
                                                       "AttachedSensor", "sensor", "Manipulator"};
  const KinBodyContents contents = read_kinbody(root, KinBodyUse::robot, sources, remarks, extra_tags);
  for (const XmlElement& child : root.children()) {
    if (child.is("sensor")) {
      remark_no_effect(remarks, child, "it is in no <AttachedSensor>");
    } else if (child.is("Manipulator")) {
      remark_no_effect(remarks, child, "a crawling robot has no manipulator");
    }
  }

  Chain chain = make_chain(contents, {document.name(), root.line()});
  RobotDescription robot;
  robot.model.name = root.attribute("name").value_or(document.path().stem().string());
  if (const auto servo = root.child("servo")) {
    robot.model.servo = read_servo(*servo, step_s);
  }
  robot.warnings = check_robot(chain);
  robot.model.links = std::move(chain.links);
  robot.model.joints = std::move(chain.joints);
  robot.kernel_limits = std::move(chain.kernel_limits);
  robot.model.sensors = read_sensors(root, robot.model, sources, remarks);
  robot.modules = read_modules(root, robot.model);
  robot.robot_control = read_robot_control(root, robot.model);
  remarks.push_back(one_line(chain.joint_map));
  return robot;
}

}  // namespace proleg::sim
