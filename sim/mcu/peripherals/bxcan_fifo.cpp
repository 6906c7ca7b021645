#include "sim/mcu/peripherals/bxcan_fifo.hpp"

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

}  // namespace proleg::sim
