#include "sim/mcu/peripherals/bxcan_receiver.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace proleg::sim {
namespace {

enum Status : std::uint32_t { full = 1U << 3U, fovr = 1U << 4U, rfom = 1U << 5U };

std::uint32_t word_of(const CanFrame& frame, std::size_t first_byte) {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) {
    word = (word << 8U) | frame.data.at(first_byte + i);
  }
  return word;
}

constexpr std::uint32_t fmr = 0x200;
constexpr std::uint32_t fm1r = 0x204;
constexpr std::uint32_t fs1r = 0x20C;
constexpr std::uint32_t ffa1r = 0x214;
constexpr std::uint32_t fa1r = 0x21C;
constexpr std::uint32_t f0r1 = 0x240;
constexpr std::uint32_t end_of_banks = f0r1 + 8 * BxCanFilters::bank_count;

constexpr std::uint32_t all_banks = (1U << BxCanFilters::bank_count) - 1;
constexpr std::uint32_t finit = 1;
constexpr std::uint32_t can2sb = 0x3F00;

/// Bits of a standard data frame that a filter compares: the identifier in the upper bits, the rest zeros.
constexpr std::uint32_t wide_image(std::uint16_t identifier) { return std::uint32_t{identifier} << 21U; }
constexpr std::uint32_t narrow_image(std::uint16_t identifier) { return std::uint32_t{identifier} << 5U; }

/// A bank as up to four filters, in the order of their numbers.
struct Filters {
  std::array<std::uint32_t, 4> expected{};
  std::array<std::uint32_t, 4> mask{};
  unsigned count = 0;

  void add(std::uint32_t identifier, std::uint32_t relevant) {
    expected.at(count) = identifier;
    mask.at(count) = relevant;
    ++count;
  }
  /// Position of the first filter that accepts a frame; `count` if none does.
  [[nodiscard]] unsigned first_match(std::uint32_t image) const {
    unsigned i = 0;
    while (i < count && ((image ^ expected.at(i)) & mask.at(i)) != 0) {
      ++i;
    }
    return i;
  }
};

Filters filters_of(const std::array<std::uint32_t, 2>& bank, bool is_wide, bool is_list) {
  constexpr std::uint32_t every_bit = 0xFFFF'FFFF;
  constexpr std::uint32_t half = 0xFFFF;
  Filters filters;
  if (is_wide && is_list) {
    filters.add(bank[0], every_bit);
    filters.add(bank[1], every_bit);
  } else if (is_wide) {
    filters.add(bank[0], bank[1]);
  } else {
    for (const std::uint32_t word : bank) {
      if (is_list) {
        filters.add(word & half, half);
        filters.add(word >> 16U, half);
      } else {
        filters.add(word & half, word >> 16U);
      }
    }
  }
  return filters;
}

}  // namespace

std::uint32_t BxCanFifo::status() const { return count_ | (full_ ? full : 0U) | (overrun_ ? fovr : 0U); }

void BxCanFifo::write_status(std::uint32_t value) {
  full_ = full_ && (value & full) == 0;
  overrun_ = overrun_ && (value & fovr) == 0;
  if ((value & rfom) != 0 && count_ > 0) {
    first_ = (first_ + 1) % depth;
    --count_;
  }
}

std::uint32_t BxCanFifo::read(std::uint32_t word) const {
  const Stored& stored = stored_.at(count_ > 0 ? first_ : (first_ + depth - 1) % depth);
  switch (word) {
    case 0:
      return std::uint32_t{stored.frame.identifier} << 21U;
    case 1:
      return stored.frame.length | (stored.filter_match_index << 8U);
    default:
      return word_of(stored.frame, word == 2 ? 0 : 4);
  }
}

void BxCanFifo::store(const CanFrame& frame, unsigned filter_match_index, bool locked) {
  if (count_ == depth) {
    overrun_ = true;
    if (!locked) {
      stored_.at((first_ + depth - 1) % depth) = {frame, filter_match_index};
    }
    return;
  }
  stored_.at((first_ + count_) % depth) = {frame, filter_match_index};
  ++count_;
  full_ = full_ || count_ == depth;
}

bool BxCanFilters::contains(std::uint32_t offset) {
  switch (offset) {
    case fmr:
    case fm1r:
    case fs1r:
    case ffa1r:
    case fa1r:
      return true;
    default:
      return offset >= f0r1 && offset < end_of_banks;
  }
}

std::string BxCanFilters::register_name(std::uint32_t offset) {
  switch (offset) {
    case fmr:
      return "FMR";
    case fm1r:
      return "FM1R";
    case fs1r:
      return "FS1R";
    case ffa1r:
      return "FFA1R";
    case fa1r:
      return "FA1R";
    default:
      return "F" + std::to_string((offset - f0r1) / 8) + "R" + std::to_string((offset - f0r1) % 8 / 4 + 1);
  }
}

const std::uint32_t* BxCanFilters::configuration(std::uint32_t offset) const {
  switch (offset) {
    case fmr:
      return &master_;
    case fm1r:
      return &list_mode_;
    case fs1r:
      return &wide_;
    case ffa1r:
      return &assignment_;
    case fa1r:
      return &active_;
    default:
      return nullptr;
  }
}

std::uint32_t BxCanFilters::read(std::uint32_t offset) const {
  if (const std::uint32_t* const found = configuration(offset)) {
    return *found;
  }
  return banks_.at((offset - f0r1) / 8).at((offset - f0r1) % 8 / 4);
}

std::optional<std::string> BxCanFilters::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == fmr) {
    if (((value & can2sb) >> 8U) > bank_count) {
      return "CAN2SB is above 28";
    }
    if (((value ^ master_) & ~(finit | can2sb)) != 0) {
      return "the reserved bits must keep their values of the reset (RM0090, section 32.9.4)";
    }
    master_ = value;
    return std::nullopt;
  }
  if (offset >= f0r1) {
    const std::uint32_t bank = (offset - f0r1) / 8;
    if (!is_initialising() && ((active_ >> bank) & 1U) != 0) {
      return "write-protected while FA1R.FACT" + std::to_string(bank) + " is 1 and FMR.FINIT is 0";
    }
    banks_.at(bank).at((offset - f0r1) % 8 / 4) = value;
    return std::nullopt;
  }
  if (offset != fa1r && !is_initialising()) {
    return "write-protected while FMR.FINIT is 0";
  }
  if ((value & ~all_banks) != 0) {
    return "there are 28 filter banks";
  }
  (offset == fm1r ? list_mode_ : offset == fs1r ? wide_ : offset == ffa1r ? assignment_ : active_) = value;
  return std::nullopt;
}

std::optional<BxCanFilters::Match> BxCanFilters::match(std::uint16_t identifier) const {
  if (is_initialising()) {
    return std::nullopt;
  }
  std::optional<Match> best;
  unsigned best_rank = 0;  // filters of 32 bits come before those of 16, then lists before masks, then lower numbers
  std::array<unsigned, 2> numbers{};
  // Banks after the last active one do not count: most programs use few, and each node filters each frame.
  const unsigned end = std::min<unsigned>(first_bank_of_can2(), static_cast<unsigned>(std::bit_width(active_)));
  for (unsigned bank = 0; bank < end; ++bank) {
    const bool is_wide = ((wide_ >> bank) & 1U) != 0;
    const bool is_list = ((list_mode_ >> bank) & 1U) != 0;
    const unsigned fifo = (assignment_ >> bank) & 1U;
    const unsigned rank = 1 + (is_wide ? 2U : 0U) + (is_list ? 1U : 0U);
    if (((active_ >> bank) & 1U) != 0 && rank > best_rank) {
      const Filters filters = filters_of(banks_.at(bank), is_wide, is_list);
      const unsigned position = filters.first_match(is_wide ? wide_image(identifier) : narrow_image(identifier));
      if (position < filters.count) {
        best = Match{fifo, numbers.at(fifo) + position};
        best_rank = rank;
      }
    }
    numbers.at(fifo) += (is_wide ? 1U : 2U) * (is_list ? 2U : 1U);  // whether the bank is active or not
  }
  return best;
}

}  // namespace proleg::sim
