#include "sim/hardware_loop/motion_watch.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::sim {
namespace {

using canopen::PowerState;

const char* describe(canopen::NmtState state) {
  switch (state) {
    case canopen::NmtState::boot_up:
      return "starts (boot-up)";
    case canopen::NmtState::stopped:
      return "NMT Stopped";
    case canopen::NmtState::operational:
      return "NMT Operational";
    case canopen::NmtState::pre_operational:
      return "NMT Pre-operational";
  }
  return "";
}

constexpr double deg_per_count = 90.0 / servo_quarter_turn;
/// Pulses of virtual chips are measured between edges: 500 ppm of a crystal, and the rounding.
constexpr std::int32_t width_tolerance = 14;
constexpr BusTime half_a_second = 500'000'000;
constexpr BusTime max_motion_without_command = 3 * half_a_second;

}  // namespace

const char* describe(JointState state) {
  switch (state) {
    case JointState::limp:
      return "limp";
    case JointState::operation:
      return "follows the gait";
    case JointState::stopping:
      return "quick stop";
    case JointState::hold:
      return "holds the safe pose";
  }
  return "";
}

const char* describe(JointEnd end) {
  switch (end) {
    case JointEnd::operation:
      return "operation";
    case JointEnd::hold:
      return "hold";
    case JointEnd::limp:
      return "limp";
    case JointEnd::silent:
      return "silent";
    case JointEnd::unsafe:
      return "unsafe";
  }
  return "";
}

MotionWatch::MotionWatch(const Scenario& scenario)
    : scenario_(scenario),
      joints_(scenario.modules.size()),
      period_(BusTime{scenario.robot.servo.period_us} * 1'000),
      ends_(scenario.modules.size(), JointEnd::unsafe) {
  constexpr double guard_and_crystal = 65.0 / 64.0 * 1.001;
  const double counts_per_s = scenario.robot.servo.command_speed / deg_per_count;
  max_change_ = counts_per_s * scenario.robot.servo.period_us * 1e-6;
  counts_per_ns_ = counts_per_s * 1e-9 * guard_and_crystal;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const AngleLimits& limits = scenario.joint_limits[i];
    joints_[i].node = scenario.modules[i].node;
    joints_[i].lower = servo_command(limits.lower);
    joints_[i].upper = servo_command(limits.upper);
    joints_[i].safe = servo_command(std::clamp(0, limits.lower, limits.upper));
  }
}

bool MotionWatch::follows_pulses(const Joint& joint, const JointModule::WatchedPulse& pulse) const {
  return joint.last_pulse && pulse.follows_pulses.value_or(pulse.begin < *joint.last_pulse + 5 * period_ / 2);
}

void MotionWatch::note_pulse(unsigned joint, const JointModule::WatchedPulse& pulse) {
  const auto [begin, width, power, known, is_whole] = pulse;
  Joint& servo = joints_[joint];
  if (!is_whole) {
    add_event(joint, begin, "a pulse is cut: its chip has no power or no clock");
    servo.last_pulse.reset();
    return;
  }
  const std::int32_t beyond = std::max(servo.lower - width, width - servo.upper);
  worst_.beyond_limit_deg = std::max(worst_.beyond_limit_deg, beyond * deg_per_count);
  if (beyond > width_tolerance) {
    violate(joint, begin, "a pulse " + number_text(beyond * deg_per_count) + " degrees beyond its limits");
  }
  if (power != PowerState::operation_enabled && power != PowerState::quick_stop_active) {
    violate(joint, begin, "a pulse although its drive is neither enabled nor in a quick stop");
  }
  if (follows_pulses(servo, pulse)) {
    check_change(joint, pulse);
  } else {
    servo.train_begin = begin;
    servo.least_rising = servo.greatest_falling = width;
  }
  servo.last_pulse = begin;
  servo.width = width;
}

void MotionWatch::check_change(unsigned joint, const JointModule::WatchedPulse& pulse) {
  const auto [begin, width, power, known, is_whole] = pulse;
  constexpr double bursts = 2.5;  // periods' worth of motion that pulses close together may add up to
  Joint& servo = joints_[joint];
  const int change = std::abs(width - servo.width);
  // At the pin of a chip, a pulse hides the requests that come while it is high: the next one that is seen may be two
  // requests on, or more if the pulse is longer than the servo period.
  const double periods = std::round(static_cast<double>(begin - *servo.last_pulse) / static_cast<double>(period_));
  const double steps = known ? 1.0 : std::max(periods, 1.0) + 1.0;
  worst_.change_steps = std::max(worst_.change_steps, change / max_change_);
  if (change > max_change_ * steps + 1 + width_tolerance) {
    violate(joint, begin, "a jump of " + number_text(change * deg_per_count) + " degrees");
  }
  const double passed = static_cast<double>(begin - servo.train_begin) * counts_per_ns_;
  const double excess = std::max(width - passed - servo.least_rising, servo.greatest_falling - (width + passed));
  if (excess > bursts * max_change_ + 2 * width_tolerance) {
    violate(joint, begin,
            "pulses that add up to " + number_text(excess * deg_per_count) + " degrees above the greatest speed");
  }
  servo.least_rising = std::min(servo.least_rising, width - passed);
  servo.greatest_falling = std::max(servo.greatest_falling, width + passed);
  if (change > width_tolerance) {
    servo.last_motion = begin;
  }
}

void MotionWatch::check_command(unsigned joint, BusTime begin) {
  const BusTime last = std::min(joints_[joint].last_tick, host_heard_);
  const BusTime passed = begin > last ? begin - last : 0;
  worst_.motion_after_command_s = std::max(worst_.motion_after_command_s, static_cast<double>(passed) * 1e-9);
  if (passed > max_motion_without_command) {
    violate(joint, begin,
            "motion " + number_text(static_cast<double>(passed) * 1e-9) + " s after the last " +
                (last == host_heard_ ? "heartbeat of the host" : "tick"));
  }
}

void MotionWatch::note_frame(const Transmission& transmission) {
  const CanFrame& frame = transmission.frame;
  if (const auto heartbeat = canopen::decode_heartbeat(frame)) {
    if (heartbeat->node == canopen::host_node) {
      host_heard_ = transmission.end;
      return;
    }
    for (unsigned joint = 0; joint < joints_.size(); ++joint) {
      Joint& module = joints_[joint];
      if (module.node == heartbeat->node) {
        module.last_heard = transmission.end;
        if (module.nmt != heartbeat->state) {
          module.nmt = heartbeat->state;
          add_event(joint, transmission.end, describe(heartbeat->state));
        }
      }
    }
  } else if (const auto emergency = canopen::decode_emergency(frame)) {
    for (unsigned joint = 0; joint < joints_.size(); ++joint) {
      if (joints_[joint].node == emergency->node) {
        add_event(joint, transmission.end,
                  "EMCY " + hexadecimal(static_cast<std::uint16_t>(emergency->code), 4) + ", " +
                      std::string(canopen::describe(emergency->code)));
      }
    }
  }
}

void MotionWatch::note_tick(unsigned joint, BusTime now, const ModuleNow& module) {
  Joint& servo = joints_[joint];
  if (module.has_computed) {
    servo.last_tick = now;
  }
  if (servo.last_motion) {
    check_command(joint, *std::exchange(servo.last_motion, std::nullopt));
  }
  if (!module.gives_pulses) {
    set_state(joint, now, JointState::limp);
  } else if (module.power == PowerState::operation_enabled) {
    set_state(joint, now, JointState::operation);
  } else {
    const bool is_safe = std::abs(servo.width - servo.safe) <= width_tolerance;
    set_state(joint, now, is_safe ? JointState::hold : JointState::stopping);
  }
}

void MotionWatch::finish(BusTime now) {
  for (unsigned joint = 0; joint < joints_.size(); ++joint) {
    const Joint& servo = joints_[joint];
    JointEnd& end = ends_[joint];
    switch (servo.state) {
      case JointState::limp:
        end = now - servo.last_heard < max_motion_without_command ? JointEnd::limp : JointEnd::silent;
        break;
      case JointState::operation:
        if (now - servo.last_tick <= half_a_second) {
          end = JointEnd::operation;
        } else {
          violate(joint, now, "its servo is enabled without a tick for half a second");
        }
        break;
      case JointState::stopping:
        violate(joint, now, "its servo is on its way to the safe pose at the end of the run");
        break;
      case JointState::hold:
        end = JointEnd::hold;
        break;
    }
  }
}

void MotionWatch::set_state(unsigned joint, BusTime now, JointState state) {
  if (joints_[joint].state != state) {
    joints_[joint].state = state;
    add_event(joint, now, describe(state));
  }
}

void MotionWatch::add_event(unsigned joint, BusTime now, std::string text) {
  constexpr std::size_t max_events = 1'000;
  if (start_ != 0 && events_.size() < max_events) {
    events_.push_back({seconds(now), joint, std::move(text)});
  }
}

void MotionWatch::violate(unsigned joint, BusTime now, const std::string& text) {
  constexpr std::size_t max_violations = 20;
  if (violations_.size() < max_violations) {
    std::ostringstream line;
    line.precision(6);
    line << std::fixed << seconds(now) << " s: " << scenario_.robot.joints[joint].name << ": " << text;
    violations_.push_back(line.str());
  }
}

}  // namespace proleg::sim
