#include "sim/loop/kernel_chain.hpp"

#include <algorithm>
#include <limits>
#include <string>

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

}  // namespace proleg::sim
