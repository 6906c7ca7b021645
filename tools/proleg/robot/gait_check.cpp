#include "tools/proleg/robot/gait_check.hpp"

#include <algorithm>
#include <numbers>

#include "shared/computer/text/text.hpp"
#include "sim/loop/module_readings.hpp"

namespace proleg::tools {
namespace {

std::string bytes_text(const StateFrame& frame) {
  std::string text;
  for (const std::uint8_t byte : frame.bytes) {
    text += (text.empty() ? "" : " ") + hexadecimal(byte, 2).substr(2);
  }
  return text;
}

/// The frame without what the gait does not decide: the drive's fault, and whether a SYNC was missing.
StateFrame comparable(StateFrame frame) {
  constexpr unsigned not_computed = StateFrame::fault | StateFrame::holdover;
  frame.bytes[6] = static_cast<std::uint8_t>(frame.bytes[6] & ~not_computed);
  return frame;
}

}  // namespace

double radians(const canopen::Monitoring& measured) {
  constexpr double step = std::numbers::pi / 2 / (1 << 14);
  return measured.angle * step;
}

GaitCheck::GaitCheck(const sim::Scenario& scenario)
    : scenario_(scenario),
      gait_({.kernel = scenario.kernel,
             .limits = scenario.joint_limits,
             .settings = scenario.settings,
             .changes = changes_,
             .servo_period_us = scenario.robot.servo.period_us,
             .command_speed = scenario.robot.servo.command_speed}),
      setpoint_check_(scenario.robot.joints.size()),
      contacts_(scenario.robot.joints.size()),
      link_contacts_(scenario.robot.links.size()),
      commands_(scenario.robot.joints.size(), servo_command(0)),
      angles_(scenario.robot.joints.size()),
      torques_(scenario.robot.joints.size()),
      currents_(scenario.robot.joints.size()),
      forces_(scenario.robot.links.size()) {
  for (const auto& link : scenario.robot.links) {
    poses_.push_back(scenario.environment.robot_pose * link.pose);
  }
  senses_contacts_ = std::ranges::any_of(scenario.kernel.slots, [](const Slot& slot) {
    return slot.algorithm != nullptr && slot.algorithm->senses_contacts();
  });
  if (gait_.chain().needs_readings()) {
    end_comparison("the gait reads what the modules measure, which the host does not receive at every tick");
    knows_setpoints_ = false;
  }
}

void GaitCheck::add_change(const Change& change) {
  const auto first = changes_.begin() + static_cast<std::ptrdiff_t>(gait_.next_change());
  const auto place = std::ranges::upper_bound(first, changes_.end(), change.tick, {}, &Change::tick);
  changes_.insert(place, change);
}

void GaitCheck::end_comparison(const std::string& why) {
  if (!end_of_comparison_) {
    end_of_comparison_ = "from tick " + std::to_string(gait_.tick()) + " on nothing was compared: " + why;
  }
}

std::string GaitCheck::name_of(unsigned joint) const {
  return scenario_.robot.joints[joint].name + " (node " + std::to_string(scenario_.modules[joint].node) + ")";
}

const std::string* GaitCheck::unknown_contacts(const host::TickFrames& tick) const {
  for (unsigned joint = 0; senses_contacts_ && joint < contacts_.size(); ++joint) {
    if (!tick.frames[joint][0]) {
      return &scenario_.robot.joints[joint].name;
    }
  }
  return nullptr;
}

void GaitCheck::follow_stopping(const host::TickFrames& tick) {
  knows_setpoints_ = knows_setpoints_ && unknown_contacts(tick) == nullptr;
  advance(tick);
}

void GaitCheck::compare_setpoints(unsigned joint, const canopen::Master::SetpointChecksum& found) {
  using Result = host::SetpointCheck::Result;
  if (end_of_comparison_) {
    return;
  }
  const Result result = setpoint_check_.compare(joint, found);
  if (result == Result::equal) {
    equal_setpoints_.push_back(name_of(joint));
  } else if (result == Result::different) {
    different_setpoints_.push_back(name_of(joint));
  } else {
    not_compared_setpoints_.push_back(name_of(joint) + ": " + why_not_compared(result));
  }
}

/// Computes the next tick with the contacts of the modules.
const Change* GaitCheck::advance(const host::TickFrames& tick) {
  const Change* const change = gait_.apply_due_changes();
  for (unsigned joint = 0; joint < contacts_.size(); ++joint) {
    if (const auto& frame = tick.frames[joint][0]) {
      contacts_[joint] = static_cast<std::uint8_t>(frame->flags() & StateFrame::contact_bits);
    }
    sim::write_link_contacts(link_contacts_, joint, contacts_[joint]);
  }
  gait_.advance(contacts_);
  if (knows_setpoints_) {
    setpoint_check_.add(setpoints());
  }
  return change;
}

const Change* GaitCheck::follow(const host::TickFrames& tick) {
  if (const std::string* joint = unknown_contacts(tick)) {
    end_comparison("a state frame of " + *joint + " was not received, and the gait depends on its contacts");
  }
  const Change* change = advance(tick);
  ++ticks_;
  for (unsigned joint = 0; joint < contacts_.size(); ++joint) {
    for (unsigned channel = 0; channel < gait_.chain().kernel(joint).channel_count(joint); ++channel) {
      compare(joint, channel, tick.frames[joint].at(channel));
    }
  }
  setpoint_hash_.append(setpoints());
  for (const sim::ServoPulse& pulse : gait_.pulses()) {
    servo_hash_.append(pulse.command);
    commands_[pulse.joint] = pulse.command;
  }
  return change;
}

void GaitCheck::compare(unsigned joint, unsigned channel, const std::optional<StateFrame>& found) {
  if (end_of_comparison_) {
    return;
  }
  if (!found) {
    ++missing_;
    return;
  }
  ++compared_;
  const StateFrame expected = comparable(gait_.chain().kernel(joint).frame(joint, channel));
  if (comparable(*found) == expected) {
    return;
  }
  if (++differences_ == 1) {
    first_difference_ = "tick " + std::to_string(gait_.tick() - 1) + ", " + name_of(joint) + ": state frame: found " +
                        bytes_text(comparable(*found)) + ", expected " + bytes_text(expected);
  }
}

sim::TickSample GaitCheck::sample(const host::RobotDrive& drive) {
  for (unsigned joint = 0; joint < contacts_.size(); ++joint) {
    if (const auto& measured = drive.monitoring(joint)) {
      if (measured->angle != canopen::Monitoring::not_measured) {
        angles_[joint] = radians(*measured);
      }
      currents_[joint] = measured->current_ma;
    }
  }
  sim::TickSample sample = gait_.sample();
  sample.latched_contacts = link_contacts_;
  sample.servo_commands = commands_;
  sample.link_poses = poses_;
  sample.joint_angles = angles_;
  sample.motor_torques = torques_;
  sample.servo_currents = currents_;
  sample.contact_forces = forces_;
  return sample;
}

}  // namespace proleg::tools
