#include "firmware/module/network_node.hpp"

#include "shared/canopen/objects.hpp"

namespace proleg::firmware {

using canopen::NmtState;

void NetworkNode::start(Microseconds now) {
  state_ = NmtState::boot_up;
  boot_up_at_ = now + 1'000U * (1U + serial_number(board_) % 16U);
  heartbeat_period_ms_ = canopen::object::heartbeat_period.default_value;
  heartbeat_at_ = never;
}

void NetworkNode::repeat_boot_up(Microseconds now) {
  state_ = NmtState::boot_up;
  boot_up_at_ = now;
}

void NetworkNode::enter(NmtState state) {
  state_ = state;
  boot_up_at_ = never;
}

void NetworkNode::set_heartbeat_period(Microseconds now, std::uint16_t period_ms) {
  heartbeat_period_ms_ = period_ms;
  heartbeat_at_ = period_ms == 0 ? never : now;
}

void NetworkNode::poll(Microseconds now) {
  poll_boot_up(now);
  poll_heartbeat(now);
}

void NetworkNode::poll_boot_up(Microseconds now) {
  if (now < boot_up_at_) {
    return;
  }
  if (outbox_.send(encode(canopen::Heartbeat{board_.node, NmtState::boot_up}))) {
    enter(NmtState::pre_operational);
  } else {
    boot_up_at_ = now + 1'000U;
  }
}

void NetworkNode::poll_heartbeat(Microseconds now) {
  if (now < heartbeat_at_) {
    return;
  }
  outbox_.send(encode(canopen::Heartbeat{board_.node, state_}));
  const Microseconds period_us = Microseconds{heartbeat_period_ms_} * 1'000U;
  heartbeat_at_ += period_us;
  if (heartbeat_at_ <= now) {
    heartbeat_at_ = now + period_us;
  }
}

Microseconds NetworkNode::next_deadline() const { return boot_up_at_ < heartbeat_at_ ? boot_up_at_ : heartbeat_at_; }

}  // namespace proleg::firmware
