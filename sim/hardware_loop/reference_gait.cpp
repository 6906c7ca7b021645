#include "sim/hardware_loop/reference_gait.hpp"

namespace proleg::sim {

ReferenceGait::ReferenceGait(const Scenario& scenario, const Losses* losses)
    : scenario_(scenario),
      chain_(scenario.kernel, scenario.joint_limits, scenario.settings),
      touch_(scenario.robot.joints.size()),
      failed_(scenario.robot.joints.size()),
      readings_(scenario.robot.joints.size()),
      pulse_source_({scenario.robot.servo.period_us, scenario.kernel.tick_period_us}, scenario.joint_limits,
                    scenario.robot.servo.command_speed) {
  chain_.set_losses(losses);
}

void ReferenceGait::follow(unsigned joint, const ModuleTick& module, HardwareReport& report) {
  if (chain_.is_running(joint)) {
    if (module.has_restarted || stands_in_for(joint)) {
      stop(joint, report);
    } else if (!module.has_computed) {
      fail(joint, report);
      if (!module.has_sent) {
        stop(joint, report);
      }
    }
  } else if (module.has_computed || module.has_sent) {
    failed_[joint] = false;
    chain_.join(joint);
    report.restart_events.push_back({joint, true});
    if (!module.has_computed) {
      fail(joint, report);
    }
  }
}

void ReferenceGait::fail(unsigned joint, HardwareReport& report) {
  failed_[joint] = true;
  report.failures.push_back({chain_.tick(), joint});
  report.add({Difference::Kind::missed_tick, chain_.tick(), joint, std::nullopt, std::nullopt});
}

void ReferenceGait::stop(unsigned joint, HardwareReport& report) {
  chain_.stop(joint);
  touch_.reset(joint);
  report.restart_events.push_back({joint, false});
}

std::optional<std::size_t> ReferenceGait::due_change() const {
  const bool is_due = next_change_ < scenario_.changes.size() && scenario_.changes[next_change_].tick == chain_.tick();
  return is_due ? std::optional(next_change_) : std::nullopt;
}

void ReferenceGait::set_current(unsigned joint, std::uint16_t current_ma) {
  readings_[joint] = {};
  readings_[joint].present = JointReadings::servo_current;
  readings_[joint].current_ma = current_ma;
  readings_[joint] = readings_[joint].only(chain_.kernel(joint).needed_readings(joint));
  chain_.set_readings(joint, readings_[joint]);
}

const Change* ReferenceGait::advance(std::span<const std::uint8_t> link_contacts, bool is_change_made) {
  const Change* change = nullptr;
  if (const auto due = due_change()) {
    ++next_change_;
    if (is_change_made) {
      change = &scenario_.changes[*due];
      chain_.apply(*change);
    }
  }
  for (unsigned joint = 0; joint < chain_.joint_count(); ++joint) {
    if (chain_.is_running(joint)) {
      touch_.sample(link_contacts, joint);
    }
  }
  chain_.advance(touch_.contacts());
  return change;
}

void ReferenceGait::compare(std::span<const std::int32_t> setpoints, std::span<const ServoPulse> pulses,
                            HardwareReport& report) {
  const auto add = [&report](const Difference& difference) { report.add(difference); };
  const std::uint32_t tick = chain_.tick() - 1;
  compare_setpoints(tick, setpoints, chain_.setpoints(), add);
  expected_pulses_.clear();
  pulse_source_.append(chain_, expected_pulses_);
  std::erase_if(expected_pulses_, [this](const ServoPulse& pulse) { return has_failed(pulse.joint); });
  compare_pulses(tick, pulses, expected_pulses_, add);
}

}  // namespace proleg::sim
