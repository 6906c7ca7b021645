#include "sim/mcu/peripherals/iwdg.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace proleg::sim {
namespace {

constexpr std::uint32_t kr = 0x00;
constexpr std::uint32_t pr = 0x04;
constexpr std::uint32_t rlr = 0x08;
constexpr std::uint32_t sr = 0x0C;
constexpr RegisterName registers[] = {{kr, "KR"}, {pr, "PR"}, {rlr, "RLR"}, {sr, "SR"}};

constexpr std::uint32_t key_unlock = 0x5555;
constexpr std::uint32_t key_reload = 0xAAAA;
constexpr std::uint32_t key_start = 0xCCCC;
constexpr std::uint32_t max_count = 0xFFF;
constexpr std::uint32_t sr_pvu = 1U << 0U;
constexpr std::uint32_t sr_rvu = 1U << 1U;
constexpr std::uint64_t update_cycles = 5;

constexpr std::uint32_t slowest_lsi = 17'000;
constexpr std::uint32_t fastest_lsi = 47'000;
constexpr std::uint64_t local_time_per_s = local_time_per_us * 1'000'000;

/// LSI cycles in a count: 4 to 256; prescalers 6 and 7 have the same effect.
std::uint64_t divider(std::uint32_t prescaler) { return std::uint64_t{4} << std::min(prescaler, 6U); }

}  // namespace

Iwdg::Iwdg(ChipServices& chip, std::uint32_t lsi_hz)
    : RegisterBlock(chip, "IWDG", 0x4000'3000, 0x400, registers), lsi_hz_(lsi_hz) {
  if (lsi_hz < slowest_lsi || lsi_hz > fastest_lsi) {
    throw std::invalid_argument("LSI of " + std::to_string(lsi_hz) + " Hz: expected 17000 to 47000");
  }
}

void Iwdg::reset() {
  running_ = false;
  lsi_on_ = false;
  unlocked_ = false;
  expired_ = false;
  prescaler_ = 0;
  reload_ = max_count;
  prescaler_update_ = {};
  reload_update_ = {};
}

LocalTime Iwdg::lsi_cycles(std::uint64_t count) const { return (count * local_time_per_s + lsi_hz_ - 1) / lsi_hz_; }

LocalTime Iwdg::timeout() const { return since_ + lsi_cycles((std::uint64_t{count_} + 1) * divider(prescaler_)); }

void Iwdg::lsi_switched(bool on) {
  settle();
  lsi_on_ = on;
  schedule_updates();
}

void Iwdg::schedule_updates() {
  for (Update* update : {&prescaler_update_, &reload_update_}) {
    if (!update->pending || !lsi_runs()) {
      update->done = never_on_chip;
    } else if (update->done == never_on_chip) {
      update->done = chip().now() + lsi_cycles(update_cycles);
    }
  }
}

LocalTime Iwdg::next_event() const {
  return running_ && !expired_ ? std::min(timeout(), prescaler_update_.done) : never_on_chip;
}

void Iwdg::advance() { settle(); }

void Iwdg::settle() {
  const LocalTime now = chip().now();
  if (prescaler_update_.done <= now && (!running_ || prescaler_update_.done < timeout())) {
    if (running_) {
      const std::uint64_t cycles = (prescaler_update_.done - since_) * lsi_hz_ / local_time_per_s;
      start_count(prescaler_update_.done, count_ - static_cast<std::uint32_t>(cycles / divider(prescaler_)));
    }
    prescaler_ = prescaler_update_.value;
    prescaler_update_ = {};
  }
  if (reload_update_.done <= now) {
    reload_ = reload_update_.value;
    reload_update_ = {};
  }
  if (running_ && !expired_ && timeout() <= now) {
    expired_ = true;
    chip().request_reset(ResetCause::independent_watchdog);
  }
}

void Iwdg::start_count(LocalTime now, std::uint32_t count) {
  since_ = now;
  count_ = count;
}

std::uint32_t Iwdg::read(std::uint32_t offset) {
  settle();
  switch (offset) {
    case kr:
      return 0;  // write only
    case pr:
      return prescaler_;
    case rlr:
      return reload_;
    case sr:
      return (prescaler_update_.pending ? sr_pvu : 0) | (reload_update_.pending ? sr_rvu : 0);
    default:
      reject_read(offset);
  }
}

void Iwdg::write(std::uint32_t offset, std::uint32_t value) {
  settle();
  switch (offset) {
    case kr:
      write_key(value & 0xFFFFU);
      return;
    case pr:
    case rlr: {
      if (!unlocked_) {
        reject_write(offset, value, "write-protected: IWDG_KR = 0x5555 comes first");
      }
      Update& update = offset == pr ? prescaler_update_ : reload_update_;
      if (update.pending) {
        reject_write(offset, value, "the update before is not over (IWDG_SR)");
      }
      update = {.pending = true, .value = value & (offset == pr ? 0x7U : max_count), .done = never_on_chip};
      schedule_updates();
      return;
    }
    case sr:
      return;  // read only
    default:
      reject_write(offset, value);
  }
}

void Iwdg::write_key(std::uint32_t value) {
  unlocked_ = value == key_unlock;
  if (value == key_start && !running_) {
    running_ = true;
    start_count(chip().now(), max_count);
    schedule_updates();
  } else if (value == key_reload && running_) {
    start_count(chip().now(), reload_);
  }
}

}  // namespace proleg::sim
