#include "tools/proleg/robot/gait_check.hpp"

#include <algorithm>
#include <numbers>

#include "shared/computer/text/text.hpp"
#include "sim/loop/touch_inputs.hpp"
#include "sim/record/internal_values.hpp"

namespace proleg::tools {
namespace {

std::string bytes_text(const StateFrame& frame) {
  std::string text;
  for (const std::uint8_t byte : frame.bytes) {
    text += (text.empty() ? "" : " ") + hexadecimal(byte, 2).substr(2);
  }
  return text;
}

/// Without what the gait does not decide: the drive's fault, and whether a SYNC was missing.
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
      chain_(scenario.kernel, scenario.joint_limits, scenario.settings),
      setpoint_check_(scenario.robot.joints.size()),
      pulse_source_({scenario.robot.servo.period_us, scenario.kernel.tick_period_us}, scenario.joint_limits,
                    scenario.robot.servo.command_speed),
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
  sim::for_each_internal_value(scenario.kernel, [&](unsigned, unsigned, unsigned) { internal_values_.push_back(0); });
  senses_contacts_ = std::ranges::any_of(scenario.kernel.slots, [](const Slot& slot) {
    return slot.algorithm != nullptr && slot.algorithm->senses_contacts();
  });
  if (chain_.needs_readings()) {
    end_comparison("the gait reads what the modules measure, which the host does not receive at every tick");
    knows_setpoints_ = false;
  }
}

void GaitCheck::add_change(const sim::Change& change) {
  const auto place = std::ranges::upper_bound(changes_.begin() + static_cast<std::ptrdiff_t>(next_change_),
                                              changes_.end(), change.tick, {}, &sim::Change::tick);
  changes_.insert(place, change);
}

void GaitCheck::end_comparison(const std::string& why) {
  if (!end_of_comparison_) {
    end_of_comparison_ = "from tick " + std::to_string(chain_.tick()) + " on nothing was compared: " + why;
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
const sim::Change* GaitCheck::advance(const host::TickFrames& tick) {
  const sim::Change* change = nullptr;
  for (; next_change_ < changes_.size() && changes_[next_change_].tick <= chain_.tick(); ++next_change_) {
    change = &changes_[next_change_];
    chain_.apply(*change);
  }
  for (unsigned joint = 0; joint < contacts_.size(); ++joint) {
    if (const auto& frame = tick.frames[joint][0]) {
      contacts_[joint] = static_cast<std::uint8_t>(frame->flags() & StateFrame::contact_bits);
    }
    sim::write_link_contacts(link_contacts_, joint, contacts_[joint]);
  }
  chain_.advance(contacts_);
  if (knows_setpoints_) {
    setpoint_check_.add(chain_.setpoints());
  }
  return change;
}

const sim::Change* GaitCheck::follow(const host::TickFrames& tick) {
  if (const std::string* joint = unknown_contacts(tick)) {
    end_comparison("a state frame of " + *joint + " was not received, and the gait depends on its contacts");
  }
  const sim::Change* change = advance(tick);
  ++ticks_;
  for (unsigned joint = 0; joint < contacts_.size(); ++joint) {
    for (unsigned channel = 0; channel < chain_.kernel(joint).channel_count(joint); ++channel) {
      compare(joint, channel, tick.frames[joint].at(channel));
    }
  }
  setpoint_hash_.append(chain_.setpoints());
  pulses_.clear();
  pulse_source_.append(chain_, pulses_);
  for (const sim::ServoPulse& pulse : pulses_) {
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
  const StateFrame expected = comparable(chain_.kernel(joint).frame(joint, channel));
  if (comparable(*found) == expected) {
    return;
  }
  if (++differences_ == 1) {
    first_difference_ = "tick " + std::to_string(chain_.tick() - 1) + ", " + name_of(joint) + ": state frame: found " +
                        bytes_text(comparable(*found)) + ", expected " + bytes_text(expected);
  }
}

sim::TickSample GaitCheck::sample(const host::RobotDrive& drive) {
  auto value = internal_values_.begin();
  sim::for_each_internal_value(scenario_.kernel, [&](unsigned slot, unsigned joint, unsigned number) {
    *value++ = chain_.kernel(joint).internal_value(slot, joint, number);
  });
  for (unsigned joint = 0; joint < contacts_.size(); ++joint) {
    if (const auto& measured = drive.monitoring(joint)) {
      if (measured->angle != canopen::Monitoring::not_measured) {
        angles_[joint] = radians(*measured);
      }
      currents_[joint] = measured->current_ma;
    }
  }
  return {chain_.tick() - 1, link_contacts_, chain_.setpoints(), internal_values_, pulses_, commands_, poses_,
          angles_,           torques_,       currents_,          forces_,          {}};
}

}  // namespace proleg::tools
