#include "firmware/module/network_node.hpp"

#include "shared/canopen/objects.hpp"

namespace proleg::firmware {

using canopen::NmtState;

void NetworkNode::start(Microseconds now) {
  state_ = NmtState::boot_up;
  has_sent_boot_up_ = false;
  collision_ = 0;
  waits_for_node_ = identity_.node == 0;
  boot_up_at_ = waits_for_node_ ? never : now + boot_up_delay_us(identity_);
  heartbeat_period_ms_ = canopen::object::heartbeat_period.default_value;
  heartbeat_at_ = never;
}

void NetworkNode::repeat_boot_up(Microseconds now) {
  state_ = NmtState::boot_up;
  boot_up_at_ = waits_for_node_ ? never : now;
}

bool NetworkNode::confirm_boot_up(const CanFrame& frame) {
  if (has_sent_boot_up_ || frame.identifier != canopen::identifier::heartbeat + identity_.node) {
    return false;
  }
  has_sent_boot_up_ = true;
  return true;
}

void NetworkNode::enter(NmtState state) {
  state_ = state;
  boot_up_at_ = never;
}

bool NetworkNode::notice_collision(std::uint16_t identifier) {
  if (has_collided()) {
    return false;
  }
  collision_ = identifier;
  return true;
}

void NetworkNode::set_heartbeat_period(Microseconds now, std::uint16_t period_ms) {
  heartbeat_period_ms_ = period_ms;
  heartbeat_at_ = period_ms == 0 ? never : now;
}

bool NetworkNode::poll(Microseconds now) {
  const bool has_booted = poll_boot_up(now);
  poll_heartbeat(now);
  return has_booted;
}

bool NetworkNode::poll_boot_up(Microseconds now) {
  if (now < boot_up_at_) {
    return false;
  }
  if (!outbox_.send(encode(canopen::Heartbeat{identity_.node, NmtState::boot_up}))) {
    boot_up_at_ = now + 1'000U;
    return false;
  }
  enter(NmtState::pre_operational);
  return true;
}

void NetworkNode::poll_heartbeat(Microseconds now) {
  if (now < heartbeat_at_) {
    return;
  }
  if (has_sent_boot_up_) {  // before boot-up the heartbeat could take the place of the boot-up message
    outbox_.send_newest(encode(canopen::Heartbeat{identity_.node, state_}));
  }
  const Microseconds period_us = Microseconds{heartbeat_period_ms_} * 1'000U;
  heartbeat_at_ += period_us;
  if (heartbeat_at_ <= now) {
    heartbeat_at_ = now + period_us;
  }
}

Microseconds NetworkNode::next_deadline() const { return boot_up_at_ < heartbeat_at_ ? boot_up_at_ : heartbeat_at_; }

}  // namespace proleg::firmware
