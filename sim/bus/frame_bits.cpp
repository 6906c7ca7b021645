#include "sim/bus/frame_bits.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace proleg::sim {
namespace {

constexpr unsigned crc_bits = 15;
constexpr unsigned crc_mask = 0x7FFF;
constexpr unsigned crc_polynomial = 0x4599;

/// The register after eight more bits, by its upper eight bits exclusive-or those bits.
constexpr std::array<std::uint16_t, 256> make_crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned byte = 0; byte < table.size(); ++byte) {
    unsigned crc = byte << (crc_bits - 8);
    for (int bit = 0; bit < 8; ++bit) {
      const bool carry = (crc & 0x4000U) != 0;
      crc = (crc << 1U) & crc_mask;
      crc ^= carry ? crc_polynomial : 0;
    }
    table[byte] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> crc_table = make_crc_table();

constexpr unsigned crc_step(unsigned crc, unsigned byte) {
  return ((crc << 8U) & crc_mask) ^ crc_table[((crc >> (crc_bits - 8)) ^ byte) & 0xFFU];
}

/// The state of bit stuffing: the level of the last bit on the wire, and the number of equal bits up to it. After five
/// equal bits the stuff bit starts a new run.
struct Run {
  unsigned level;
  unsigned length;  ///< 1 to 4

  [[nodiscard]] constexpr unsigned index() const { return 2 * (length - 1) + level; }
  [[nodiscard]] static constexpr Run of(unsigned index) { return {index & 1U, index / 2 + 1}; }
};
constexpr unsigned run_count = 8;

/// Adds a bit; returns the number of stuff bits that follow it.
constexpr unsigned add_bit(Run& run, unsigned level) {
  run.length = level == run.level ? run.length + 1 : 1;
  run.level = level;
  if (run.length < 5) {
    return 0;
  }
  run = {1U - level, 1};
  return 1;
}

struct StuffStep {
  std::uint8_t run;
  std::uint8_t stuff_bits;
};

/// The effect of eight more bits on each state.
constexpr std::array<std::array<StuffStep, 256>, run_count> make_stuff_table() {
  std::array<std::array<StuffStep, 256>, run_count> table{};
  for (unsigned start = 0; start < run_count; ++start) {
    for (unsigned byte = 0; byte < 256; ++byte) {
      Run run = Run::of(start);
      unsigned stuff_bits = 0;
      for (unsigned bit = 8; bit-- > 0;) {
        stuff_bits += add_bit(run, (byte >> bit) & 1U);
      }
      table[start][byte] = {static_cast<std::uint8_t>(run.index()), static_cast<std::uint8_t>(stuff_bits)};
    }
  }
  return table;
}

constexpr std::array<std::array<StuffStep, 256>, run_count> stuff_table = make_stuff_table();

/// SOF, identifier, RTR, IDE, r0 and DLC: 19 bits, the first of them the highest of 19.
unsigned header(const CanFrame& frame) {
  return ((unsigned{frame.identifier} & CanFrame::max_identifier) << 7U) | (frame.length & 0xFU);
}

/// The frame on the wire from start of frame to the last bit of the CRC sequence.
std::vector<bool> stuffed_bits(const CanFrame& frame) {
  std::vector<bool> result{false};
  Run run{0, 1};
  const auto append = [&](unsigned bits, unsigned count) {
    while (count-- > 0) {
      const unsigned level = (bits >> count) & 1U;
      result.push_back(level != 0);
      if (add_bit(run, level) > 0) {
        result.push_back(level == 0);
      }
    }
  };
  append(header(frame), 18);
  for (const std::uint8_t byte : frame.bytes()) {
    append(byte, 8);
  }
  append(crc_sequence(frame), crc_bits);
  return result;
}

}  // namespace

std::uint16_t crc_sequence(const CanFrame& frame) {
  // Zeros before the first bit leave the register at 0, so the header is processed as three bytes.
  const unsigned bits = header(frame);
  unsigned crc = crc_step(0, bits >> 16U);
  crc = crc_step(crc, (bits >> 8U) & 0xFFU);
  crc = crc_step(crc, bits & 0xFFU);
  for (const std::uint8_t byte : frame.bytes()) {
    crc = crc_step(crc, byte);
  }
  return static_cast<std::uint16_t>(crc);
}

unsigned first_different_bit(const CanFrame& left, const CanFrame& right) {
  const std::vector<bool> one = stuffed_bits(left);
  const std::vector<bool> other = stuffed_bits(right);
  const auto [difference, unused] = std::ranges::mismatch(one, other);
  return difference == one.end() ? frame_bits(left) : static_cast<unsigned>(difference - one.begin());
}

unsigned frame_bits(const CanFrame& frame) {
  constexpr unsigned header_bits = 19;
  constexpr unsigned tail_bits = 1 + 2 + 7;  // CRC delimiter, ACK slot and delimiter, end of frame: not stuffed
  unsigned stuff_bits = 0;
  Run run{0, 1};  // start of frame
  const auto add_bits = [&](unsigned bits, unsigned count) {
    while (count-- > 0) {
      stuff_bits += add_bit(run, (bits >> count) & 1U);
    }
  };
  unsigned state = 0;
  const auto add_byte = [&](unsigned byte) {
    const StuffStep step = stuff_table[state][byte & 0xFFU];
    state = step.run;
    stuff_bits += step.stuff_bits;
  };

  const unsigned head = header(frame);
  add_bits(head >> 16U, 2);
  state = run.index();
  add_byte(head >> 8U);
  add_byte(head);
  for (const std::uint8_t byte : frame.bytes()) {
    add_byte(byte);
  }
  const unsigned crc = crc_sequence(frame);
  add_byte(crc >> 7U);
  run = Run::of(state);
  add_bits(crc, 7);
  return header_bits + 8U * frame.length + crc_bits + tail_bits + stuff_bits;
}

}  // namespace proleg::sim
