#include "sim/mcu/peripherals/timer.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace proleg::sim {
namespace {

constexpr std::uint32_t cr1 = 0x00;
constexpr std::uint32_t cr2 = 0x04;
constexpr std::uint32_t smcr = 0x08;
constexpr std::uint32_t dier = 0x0C;
constexpr std::uint32_t sr = 0x10;
constexpr std::uint32_t egr = 0x14;
constexpr std::uint32_t ccmr1 = 0x18;
constexpr std::uint32_t ccmr2 = 0x1C;
constexpr std::uint32_t ccer = 0x20;
constexpr std::uint32_t cnt = 0x24;
constexpr std::uint32_t psc = 0x28;
constexpr std::uint32_t arr = 0x2C;
constexpr std::uint32_t ccr1 = Timer::ccr1;
constexpr std::uint32_t ccr4 = 0x40;
constexpr std::uint32_t dcr = 0x48;
constexpr std::uint32_t dmar = 0x4C;
constexpr std::uint32_t option = 0x50;
constexpr RegisterName registers[] = {
    {cr1, "CR1"},     {cr2, "CR2"},   {smcr, "SMCR"}, {dier, "DIER"}, {sr, "SR"},    {egr, "EGR"},   {ccmr1, "CCMR1"},
    {ccmr2, "CCMR2"}, {ccer, "CCER"}, {cnt, "CNT"},   {psc, "PSC"},   {arr, "ARR"},  {ccr1, "CCR1"}, {0x38, "CCR2"},
    {0x3C, "CCR3"},   {ccr4, "CCR4"}, {dcr, "DCR"},   {dmar, "DMAR"}, {option, "OR"}};

constexpr std::uint32_t cr1_cen = 1U << 0U;
constexpr std::uint32_t cr1_udis = 1U << 1U;
constexpr std::uint32_t cr1_urs = 1U << 2U;
constexpr std::uint32_t cr1_opm = 1U << 3U;
constexpr std::uint32_t cr1_dir = 1U << 4U;
constexpr std::uint32_t cr1_cms = 3U << 5U;
constexpr std::uint32_t cr1_arpe = 1U << 7U;
constexpr std::uint32_t cr1_bits = 0x3FF;
constexpr std::uint32_t cr2_trigger_by_update = 2U << 4U;  // MMS

/// Flags UIF, CC1IF to CC4IF in SR, and their enable bits in DIER.
constexpr std::uint32_t flags = 0x1F;
constexpr std::uint32_t flag_update = 1U << 0U;
constexpr std::uint32_t flag_of(unsigned channel) { return 2U << channel; }
constexpr std::uint32_t egr_ug = 1U << 0U;
constexpr std::uint32_t egr_tg = 1U << 6U;

// Bits of a channel in its half of CCMR.
constexpr std::uint32_t ccmr_selection = 0x3;
constexpr std::uint32_t ccmr_clear = 1U << 7U;
enum Mode : std::uint8_t { frozen = 0, toggle = 3, force_inactive = 4, force_active = 5, pwm1 = 6, pwm2 = 7 };

// Bits of a channel in its quarter of CCER.
constexpr unsigned ccer_enable = 0;
constexpr unsigned ccer_polarity = 1;

unsigned checked(unsigned number) {
  if (number != 2 && number != 3 && number != 5) {
    throw std::invalid_argument("TIM" + std::to_string(number) + ": expected 2, 3 or 5");
  }
  return number;
}

/// Names of the timers, whose registers lie one behind the other.
constexpr const char* names[] = {"TIM2", "TIM3", "TIM4", "TIM5"};
constexpr unsigned interrupts[] = {28, 29, 30, 50};
constexpr std::uint32_t block_bytes = 0x400;

}  // namespace

// Channels have numbers from 0 in this file, from 1 in the interface.

Timer::Timer(ChipServices& chip, unsigned number)
    : RegisterBlock(chip, names[checked(number) - 2], 0x4000'0000 + block_bytes * (number - 2), block_bytes, registers),
      interrupt_(chip, interrupts[number - 2]),
      max_count_(number == 3 ? 0xFFFFU : 0xFFFF'FFFFU),
      arr_preload_(max_count_),
      arr_(max_count_) {}

void Timer::reset() {
  cr1_ = 0;
  cr2_ = 0;
  dier_ = 0;
  sr_ = 0;
  ccmr_ = {};
  ccer_ = 0;
  prescaler_preload_ = 0;
  prescaler_ = 0;
  arr_preload_ = max_count_;
  arr_ = arr_preload_;
  channels_ = {};
  count_ = 0;
  since_ = 0;
  counting_from_ = 0;
  phase_ = 0;
  interrupt_.set(false);
}

unsigned Timer::output_mode(unsigned channel) const { return field(ccmr_[channel / 2], 8 * (channel % 2) + 4, 3); }

bool Timer::preloads(unsigned channel) const { return bit(ccmr_[channel / 2], 8 * (channel % 2) + 3); }

bool Timer::reference(unsigned channel) const {
  switch (output_mode(channel)) {
    case pwm1:
      return count_ < channels_[channel].compare;
    case pwm2:
      return count_ >= channels_[channel].compare;
    case force_active:
      return true;
    case force_inactive:
      return false;
    default:
      return channels_[channel].frozen_active;
  }
}

LocalTime Timer::time_of(std::uint64_t further_counts) const {
  return static_cast<LocalTime>(since_ + static_cast<std::int64_t>(further_counts * count_period()));
}

LocalTime Timer::overflow_time() const { return time_of(std::uint64_t{arr_} - count_ + 1); }

std::optional<LocalTime> Timer::match_time(unsigned channel) const {
  const std::uint32_t compare = channels_[channel].compare;
  if (compare <= count_ || compare > arr_) {
    return std::nullopt;  // the edge is not in this period
  }
  return time_of(compare - count_);
}

bool Timer::triggers() const { return cr2_ == cr2_trigger_by_update && (cr1_ & cr1_udis) == 0; }

LocalTime Timer::next_event() const { return next_event(triggers()); }

LocalTime Timer::next_visible_event() const { return next_event(triggers() && !trigger_input_->works_unseen()); }

LocalTime Timer::next_event(bool counts_triggers) const {
  if (!counts()) {
    return never_on_chip;
  }
  const std::uint32_t wanted = dier_ & ~sr_ & flags;
  LocalTime next = never_on_chip;
  if (counts_triggers || ((wanted & flag_update) != 0 && (cr1_ & cr1_udis) == 0)) {
    next = overflow_time();
  }
  for (unsigned channel = 0; channel < channel_count; ++channel) {
    if ((wanted & flag_of(channel)) != 0) {
      next = std::min(next, match_time(channel).value_or(overflow_time()));
    }
  }
  return next;
}

void Timer::advance() { settle(); }

void Timer::settle() {
  const auto now = static_cast<std::int64_t>(chip().now());
  unsigned overflows = 0;
  while (counts()) {
    const auto period = static_cast<std::int64_t>(count_period());
    if (now - since_ < period) {
      break;
    }
    const auto passed = static_cast<std::uint64_t>((now - since_) / period);
    const std::uint64_t to_overflow = std::uint64_t{arr_} - count_ + 1;
    if (passed < to_overflow) {
      const auto reached = static_cast<std::uint32_t>(count_ + passed);
      match(count_, reached);
      count_ = reached;
      since_ += static_cast<std::int64_t>(passed) * period;
      break;
    }
    match(count_, arr_);
    since_ += static_cast<std::int64_t>(to_overflow) * period;
    overflow();
    // After two overflows all preloaded values are in effect, and each flag that a period sets is set; the rest can be
    // skipped, unless each overflow triggers.
    if (++overflows == 2 && counts() && !triggers()) {
      const auto whole = static_cast<std::int64_t>(count_period() * (std::uint64_t{arr_} + 1));
      since_ += (now - since_) / whole * whole;
    }
  }
  update_interrupt();
}

void Timer::match(std::uint32_t after, std::uint32_t upto) {
  for (unsigned channel = 0; channel < channel_count; ++channel) {
    if (channels_[channel].compare > after && channels_[channel].compare <= upto) {
      sr_ |= flag_of(channel);
    }
  }
}

void Timer::overflow() {
  // A compare value that is never reached matches at the overflow (RM0090, TIMx_SR).
  for (unsigned channel = 0; channel < channel_count; ++channel) {
    if (channels_[channel].compare > arr_) {
      sr_ |= flag_of(channel);
    }
  }
  count_ = 0;
  update(static_cast<LocalTime>(since_), true);
  for (unsigned channel = 0; channel < channel_count; ++channel) {
    if (channels_[channel].compare == 0) {
      sr_ |= flag_of(channel);
    }
  }
  if ((cr1_ & cr1_opm) != 0 && (cr1_ & cr1_udis) == 0) {
    cr1_ &= ~cr1_cen;
    phase_ = 0;
  }
}

void Timer::update(LocalTime time, bool overflowed) {
  if ((cr1_ & cr1_udis) != 0) {
    return;
  }
  prescaler_ = prescaler_preload_;
  arr_ = arr_preload_;
  for (Channel& channel : channels_) {
    channel.compare = channel.preload;
  }
  if (cr2_ == cr2_trigger_by_update) {
    trigger_input_->trigger(time);
  }
  if (overflowed || (cr1_ & cr1_urs) == 0) {
    sr_ |= flag_update;
  }
}

void Timer::update_interrupt() { interrupt_.set((sr_ & dier_ & flags) != 0); }

LocalTime Timer::prescaler_progress() const {
  const LocalTime now = chip().now();
  if (!enabled() || now < counting_from_) {
    return phase_;
  }
  const auto progress = static_cast<LocalTime>(static_cast<std::int64_t>(now) - since_);
  return progress - progress % clock();
}

void Timer::clocks_change(const Clocks& next) {
  settle();
  phase_ = prescaler_progress() / clock() * next.apb1_timers;
  since_ = static_cast<std::int64_t>(std::max(chip().now(), counting_from_)) - static_cast<std::int64_t>(phase_);
}

std::uint32_t Timer::read(std::uint32_t offset) {
  settle();
  switch (offset) {
    case cr1:
      return cr1_;
    case cr2:
      return cr2_;
    case smcr:
    case egr:
    case dcr:
    case option:
      return 0;
    case dier:
      return dier_;
    case sr:
      return sr_;
    case ccmr1:
      return ccmr_[0];
    case ccmr2:
      return ccmr_[1];
    case ccer:
      return ccer_;
    case cnt:
      return count_;
    case psc:
      return prescaler_preload_;
    case arr:
      return arr_preload_;
    default:
      if (offset >= ccr1 && offset <= ccr4) {
        return channels_[(offset - ccr1) / 4].preload;
      }
      reject_read(offset);
  }
}

void Timer::write(std::uint32_t offset, std::uint32_t value) {
  settle();
  switch (offset) {
    case cr1:
      write_cr1(value);
      break;
    case cr2:
      if (value != 0 && (value != cr2_trigger_by_update || trigger_input_ == nullptr)) {
        reject_write(offset, value, "this trigger output is not modelled");
      }
      cr2_ = value;
      break;
    case smcr:
      reject_bits(offset, value, 0xFFFF, "trigger inputs are not modelled");
      break;
    case dier:
      reject_bits(offset, value, 0x5F40, "DMA and trigger interrupts are not modelled");
      dier_ = value & flags;
      break;
    case sr:
      sr_ &= value;
      break;
    case egr:
      write_egr(value);
      break;
    case ccmr1:
      write_ccmr(0, offset, value);
      break;
    case ccmr2:
      write_ccmr(1, offset, value);
      break;
    case ccer:
      write_ccer(value);
      break;
    case cnt:
      if (value > arr_) {
        reject_write(offset, value, "above ARR (" + hexadecimal(arr_) + "): the counter would go through all 32 bits");
      }
      count_ = value;
      break;
    case psc:
      prescaler_preload_ = value & 0xFFFFU;
      break;
    case arr:
      set_arr(value);
      break;
    case dcr:
    case dmar:
      reject_write(offset, value, "DMA is not modelled");
    case option:
      reject_bits(offset, value, ~0U, "trigger remapping is not modelled");
      break;
    default:
      if (offset < ccr1 || offset > ccr4) {
        reject_write(offset, value);
      }
      const unsigned channel = (offset - ccr1) / 4;
      channels_[channel].preload = value & max_count_;
      channels_[channel].asked_in_time = reference(channel) || channels_[channel].compare == 0;
      if (!preloads(channel)) {
        channels_[channel].compare = value & max_count_;
      }
  }
  update_interrupt();
}

void Timer::write_cr1(std::uint32_t value) {
  reject_bits(cr1, value, cr1_dir | cr1_cms, "only up-counting is modelled");
  if ((value & cr1_cen) != 0 && count_ > arr_) {
    reject_write(cr1, value,
                 "CNT (" + hexadecimal(count_) + ") is above ARR (" + hexadecimal(arr_) +
                     "): the counter would go through all 32 bits");
  }
  if ((value & cr1_arpe) == 0 && arr_ != arr_preload_) {
    cr1_ &= ~cr1_arpe;
    set_arr(arr_preload_);
  }
  const bool was_enabled = enabled();
  const LocalTime progress = prescaler_progress();
  cr1_ = value & cr1_bits;
  if (enabled() == was_enabled) {
    return;
  }
  phase_ = progress;
  if (enabled()) {
    counting_from_ = chip().now() + clock();
    since_ = static_cast<std::int64_t>(counting_from_) - static_cast<std::int64_t>(phase_);
  }
}

void Timer::write_egr(std::uint32_t value) {
  reject_bits(egr, value, egr_tg, "triggers are not modelled");
  sr_ |= value & flags & ~flag_update;
  if ((value & egr_ug) == 0) {
    return;
  }
  count_ = 0;
  phase_ = 0;
  since_ = static_cast<std::int64_t>(std::max(chip().now(), counting_from_));
  update(chip().now(), false);
}

void Timer::write_ccmr(unsigned index, std::uint32_t offset, std::uint32_t value) {
  std::array<bool, 2> active{};
  for (unsigned half = 0; half < 2; ++half) {
    const std::uint32_t setting = value >> (8 * half);
    const unsigned mode = field(setting, 4, 3);
    reject_bits(offset, value, (setting & ccmr_selection) != 0 ? value : 0, "input capture is not modelled");
    reject_bits(offset, value, (setting & ccmr_clear) != 0 ? value : 0, "clearing by ETRF is not modelled");
    if (mode > frozen && mode <= toggle) {
      reject_write(offset, value,
                   "OC" + std::to_string(2 * index + half + 1) + "M = " + std::to_string(mode) +
                       ": outputs that change on a match are not modelled");
    }
    active[half] = reference(2 * index + half);
  }
  ccmr_[index] = value & 0xFFFFU;
  for (unsigned half = 0; half < 2; ++half) {
    Channel& channel = channels_[2 * index + half];
    channel.frozen_active = active[half];
    if (!preloads(2 * index + half)) {
      channel.compare = channel.preload;
    }
  }
}

void Timer::write_ccer(std::uint32_t value) {
  reject_bits(ccer, value, 0x8888, "CCxNP belongs to inputs");
  ccer_ = value & 0x3333U;
}

void Timer::set_arr(std::uint32_t value) {
  value &= max_count_;
  arr_preload_ = value;
  if ((cr1_ & cr1_arpe) != 0) {
    return;
  }
  if (enabled() && value < count_) {
    reject_write(arr, value,
                 "below the counter (" + hexadecimal(count_) + ") without ARPE: it would go through all 32 bits");
  }
  const bool counted = counts();
  arr_ = value;
  if (counts() && !counted) {
    since_ = static_cast<std::int64_t>(std::max(chip().now(), counting_from_));
  }
}

std::optional<std::uint32_t> Timer::pulse_width(unsigned channel) const {
  const unsigned index = channel - 1;
  const unsigned mode = output_mode(index);
  const bool over = (cr1_ & cr1_opm) != 0 && (cr1_ & cr1_udis) == 0 && counts() && chip().now() >= overflow_time();
  if (!enabled() || over || (mode != pwm1 && mode != pwm2) || !bit(ccer_, 4 * index + ccer_enable)) {
    return std::nullopt;
  }
  const std::uint64_t below = std::min<std::uint64_t>(channels_[index].preload, period());
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(mode == pwm1 ? below : period() - below, 0xFFFF'FFFF));
}

std::optional<LocalTime> Timer::high_time(unsigned channel) {
  settle();
  const std::optional<std::uint32_t> asked = pulse_width(channel);
  if (!asked) {
    return std::nullopt;
  }
  const unsigned index = channel - 1;
  const bool inverted = bit(ccer_, 4 * index + ccer_polarity);
  const std::uint64_t period = std::uint64_t{arr_} + 1;
  const std::uint64_t below = std::min<std::uint64_t>(channels_[index].compare, period);
  const std::uint64_t runs = output_mode(index) == pwm1 ? below : period - below;
  const std::uint64_t active = channels_[index].asked_in_time ? *asked : runs;
  return (inverted ? period - active : active) * count_period();
}

Timer::Output Timer::output(unsigned channel) {
  settle();
  const unsigned index = channel - 1;
  const bool driven = bit(ccer_, 4 * index + ccer_enable);
  return {driven, driven && reference(index) != bit(ccer_, 4 * index + ccer_polarity)};
}

LocalTime Timer::next_edge(unsigned channel) {
  settle();
  const unsigned index = channel - 1;
  const unsigned mode = output_mode(index);
  if (!counts() || !bit(ccer_, 4 * index + ccer_enable) || (mode != pwm1 && mode != pwm2)) {
    return never_on_chip;
  }
  if (const std::optional<LocalTime> match = match_time(index)) {
    return *match;
  }
  const Channel& settings = channels_[index];
  const bool nothing_to_load = settings.compare == settings.preload && arr_ == arr_preload_;
  const bool constant = settings.compare == 0 || settings.compare > arr_;
  return constant && nothing_to_load && (cr1_ & cr1_opm) == 0 ? never_on_chip : overflow_time();
}

}  // namespace proleg::sim
