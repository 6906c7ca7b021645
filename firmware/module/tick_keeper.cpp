#include "firmware/module/tick_keeper.hpp"

#include "shared/canopen/messages.hpp"

namespace proleg::firmware {

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
