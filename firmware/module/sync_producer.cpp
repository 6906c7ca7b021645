#include "firmware/module/sync_producer.hpp"

#include "shared/canopen/messages.hpp"

namespace proleg::firmware {

void SyncProducer::start(Microseconds now, std::uint32_t tick_period_us, std::uint32_t configuration_crc) {
  constexpr std::uint32_t max_lead_us = 1'000;
  if (runs()) {
    return;
  }
  state_ = State::starting;
  tick_sent_ = false;
  tick_period_us_ = tick_period_us;
  configuration_crc_ = configuration_crc;
  lead_us_ = tick_period_us / 10 < max_lead_us ? tick_period_us / 10 : max_lead_us;
  tick_ = 0;
  next_sync_ = now;
}

void SyncProducer::bus_off(Microseconds now) {
  if (state_ == State::announced) {
    state_ = State::starting;
    next_sync_ = now + lead_us_;
  }
}

bool SyncProducer::send_tick() { return outbox_.send_newest(encode(canopen::TickMessage{tick_, configuration_crc_})); }

void SyncProducer::send_sync(Microseconds now) {
  outbox_.send_newest(canopen::encode_sync(tick_));
  ++tick_;
  next_sync_ += tick_period_us_;
  tick_sent_ = false;
  if (next_sync_ <= now) {
    // The call is late by a period or more. The modules count the SYNCs of these periods as missed.
    const Microseconds missed = (now - next_sync_) / tick_period_us_ + 1;
    tick_ += static_cast<std::uint32_t>(missed);
    next_sync_ += missed * tick_period_us_;
  }
}

void SyncProducer::poll(Microseconds now) {
  if (now < next_deadline()) {
    return;
  }
  if (state_ == State::starting) {
    if (send_tick()) {
      state_ = State::announced;
    } else {
      next_sync_ = now + lead_us_;
    }
    return;
  }
  if (now >= next_sync_) {
    send_sync(now);
  }
  if (must_announce() && now >= next_sync_ - lead_us_) {
    tick_sent_ = true;
    send_tick();
  }
}

void SyncProducer::transmitted(Microseconds now, const CanFrame& frame) {
  if (state_ == State::announced && canopen::decode_tick(frame)) {
    state_ = State::running;
    tick_sent_ = true;
    next_sync_ = now + lead_us_;
  }
}

Microseconds SyncProducer::next_deadline() const {
  switch (state_) {
    case State::stopped:
    case State::announced:
      break;
    case State::starting:
      return next_sync_;
    case State::running:
      return must_announce() ? next_sync_ - lead_us_ : next_sync_;
  }
  return never;
}

}  // namespace proleg::firmware
