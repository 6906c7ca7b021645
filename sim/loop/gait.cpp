#include "sim/loop/gait.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "sim/record/recorded_run.hpp"

namespace proleg::sim {
namespace {

void expect_ok(Status status) {
  if (status != Status::ok) {
    throw KernelRefusal(std::string(describe(status)));
  }
}

}  // namespace

KernelChain::KernelChain(const KernelConfiguration& configuration, std::span<const AngleLimits> limits,
                         std::span<const Setting> settings)
    : configuration_(configuration),
      limits_(limits.begin(), limits.end()),
      running_(JointMask::first(configuration.joint_count)),
      sent_(running_),
      setpoints_(configuration.joint_count),
      clipped_ticks_(configuration.joint_count) {
  for (const Setting& setting : settings) {
    keep(setting);
  }
  for (unsigned joint = 0; joint < configuration.joint_count; ++joint) {
    kernels_.push_back(std::make_unique<KernelOf<1>>());
    configure(joint);
    setpoints_[joint] = kernels_[joint]->setpoint(joint);
  }
}

void KernelChain::configure(unsigned joint) {
  Kernel& kernel = *kernels_[joint];
  expect_ok(kernel.configure(configuration_, joint));
  expect_ok(kernel.set_limits(joint, limits_[joint].lower, limits_[joint].upper));
  for (const Setting& setting : settings_) {
    if (setting.joint == joint) {
      expect_ok(kernel.set_parameter(setting));
    }
  }
  kernel.reset();
}

std::uint16_t KernelChain::next_transaction() {
  transaction_ = transaction_ == std::numeric_limits<std::uint16_t>::max() ? 1 : transaction_ + 1;
  return transaction_;
}

void KernelChain::keep(const Setting& setting) {
  const auto same =
      std::ranges::find_if(settings_, [&setting](const Setting& kept) { return kept.has_same_place(setting); });
  if (same == settings_.end()) {
    settings_.push_back(setting);
  } else {
    same->value = setting.value;
  }
}

void KernelChain::apply(const Change& change) {
  const std::uint16_t transaction = next_transaction();
  for (unsigned joint = 0; joint < joint_count(); ++joint) {
    if (running_.contains(joint)) {
      expect_ok(kernels_[joint]->open(transaction));
    }
  }
  for (const Setting& setting : change.settings) {
    if (!setting.internal) {
      keep(setting);
    }
    if (running_.contains(setting.joint)) {
      expect_ok(kernels_[setting.joint]->stage(transaction, setting));
    }
  }
  for (unsigned joint = 0; joint < joint_count(); ++joint) {
    if (running_.contains(joint)) {
      expect_ok(kernels_[joint]->commit(transaction, tick_));
    }
  }
}

void KernelChain::stop(unsigned joint) { running_.erase(joint); }

void KernelChain::join(unsigned joint) {
  configure(joint);
  kernels_[joint]->join(tick_);
  running_.insert(joint);
}

bool KernelChain::needs_readings() const {
  bool needs = false;
  for (unsigned joint = 0; joint < joint_count(); ++joint) {
    needs = needs || kernels_[joint]->needed_readings(joint) != 0;
  }
  return needs;
}

void KernelChain::exchange_frames() {
  lost_.clear();
  receptions_ = 0;
  const bool any_losses = losses_ != nullptr && losses_->any();
  for (unsigned sender = 0; sender < joint_count(); ++sender) {
    const Kernel& source = *kernels_[sender];
    for (unsigned channel = 0; sent_.contains(sender) && channel < source.channel_count(sender); ++channel) {
      const StateFrame& frame = source.frame(sender, channel);
      const JointMask without = any_losses ? losses_->receivers_without(tick_, sender, channel) : JointMask();
      for (unsigned receiver = 0; receiver < joint_count(); ++receiver) {
        if (receiver == sender || !running_.contains(receiver)) {
          continue;
        }
        ++receptions_;
        if (without.contains(receiver)) {
          lost_.push_back({tick_, static_cast<std::uint8_t>(sender), static_cast<std::uint8_t>(channel),
                           static_cast<std::uint8_t>(receiver)});
        } else {
          kernels_[receiver]->receive(sender, channel, frame);
        }
      }
    }
  }
}

void KernelChain::advance(std::span<const std::uint8_t> contacts) {
  exchange_frames();
  for (unsigned joint = 0; joint < joint_count(); ++joint) {
    if (running_.contains(joint)) {
      Kernel& kernel = *kernels_[joint];
      kernel.set_contacts(joint, contacts[joint]);
      kernel.advance();
      setpoints_[joint] = kernel.setpoint(joint);
      clipped_ticks_[joint] += (kernel.frame(joint, 0).flags() & StateFrame::limited) != 0 ? 1U : 0U;
    }
  }
  sent_ = running_;
  ++tick_;
}

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
