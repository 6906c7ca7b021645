#include "firmware/module/sync.hpp"

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

bool TickKeeper::announce(std::uint32_t tick, std::uint32_t coming) {
  if (keeps_tick() && coming - tick - 1U < max_late) {
    return true;  // TICK waited for the bus until its SYNC, or a few more, were sent
  }
  const bool fits = !keeps_tick() || tick - coming <= max_missed;
  if (!fits) {
    lose();
  }
  announced_ = true;
  announced_tick_ = tick;
  return fits;
}

SyncMeaning TickKeeper::sync(std::uint8_t counter, std::uint32_t coming) {
  using Action = SyncMeaning::Action;
  SyncMeaning meaning;
  if (keeps_tick()) {
    const std::uint32_t ahead = canopen::ticks_until_counter(coming, counter);
    if (ahead == canopen::sync_counters - 1) {  // the SYNC is a repetition of the one before
      return meaning;
    }
    if (ahead <= max_missed && (!announced_ || announced_tick_ - coming <= ahead)) {
      announced_ = false;
      meaning.joined = state_ == State::joining;
      state_ = State::computing;
      meaning.action = Action::compute;
      meaning.missed = static_cast<std::uint8_t>(ahead);
      return meaning;
    }
    state_ = State::lost;
    meaning.lost = true;
  }
  if (announced_ && counter == canopen::sync_counter(announced_tick_)) {
    meaning.action = announced_tick_ == 0 ? Action::compute : Action::join;
    meaning.tick = announced_tick_;
    state_ = announced_tick_ == 0 ? State::computing : State::joining;
  }
  announced_ = false;
  return meaning;
}

}  // namespace proleg::firmware
