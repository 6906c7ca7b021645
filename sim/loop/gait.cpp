#include "sim/loop/gait.hpp"

#include "sim/record/internal_values.hpp"

namespace proleg::sim {

Gait::Gait(const Parts& parts)
    : kernel_(parts.kernel),
      changes_(parts.changes),
      chain_(parts.kernel, parts.limits, parts.settings),
      pulse_source_({parts.servo_period_us, parts.kernel.tick_period_us}, parts.limits, parts.command_speed) {}

Gait::Gait(const Scenario& scenario)
    : Gait({.kernel = scenario.kernel,
            .limits = scenario.joint_limits,
            .settings = scenario.settings,
            .changes = scenario.changes,
            .servo_period_us = scenario.robot.servo.period_us,
            .command_speed = scenario.robot.servo.command_speed}) {}

std::optional<std::size_t> Gait::due_change() const {
  const bool is_due = next_change_ < changes_.size() && changes_[next_change_].tick <= tick();
  return is_due ? std::optional(next_change_) : std::nullopt;
}

const Change* Gait::apply_due_changes() {
  const Change* last = nullptr;
  while (const auto due = due_change()) {
    last = &changes_[*due];
    chain_.apply(*last);
    ++next_change_;
  }
  return last;
}

void Gait::advance(std::span<const std::uint8_t> contacts) {
  chain_.advance(contacts);
  pulses_.clear();
  pulse_source_.append(chain_, pulses_);
}

TickSample Gait::sample() {
  internal_values_.clear();
  for_each_internal_value(kernel_, [this](unsigned slot, unsigned joint, unsigned number) {
    internal_values_.push_back(chain_.kernel(joint).internal_value(slot, joint, number));
  });
  return {.tick = tick() - 1,
          .setpoints = chain_.setpoints(),
          .internal_values = internal_values_,
          .servo_pulses = pulses_,
          .lost = chain_.lost()};
}

}  // namespace proleg::sim
