#pragma once

// What loads and stores of one register and of several have in common.

#include <cstddef>
#include <cstdint>
#include <utility>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/instruction.hpp"

namespace proleg::sim::transfer {

enum class Type : std::uint8_t { word, half, byte, signed_half, signed_byte };

/// Loads a value into a register, extended as its type says. False: a fault.
template <Type type>
[[nodiscard]] bool load(Core& core, std::uint32_t address, std::uint32_t& value) {
  if constexpr (type == Type::word) {
    return core.load<std::uint32_t>(address, value);
  } else if constexpr (type == Type::half) {
    return core.load<std::uint16_t>(address, value);
  } else if constexpr (type == Type::byte) {
    return core.load<std::uint8_t>(address, value);
  } else if constexpr (type == Type::signed_half) {
    const bool is_done = core.load<std::uint16_t>(address, value);
    value = static_cast<std::uint32_t>(std::int32_t{static_cast<std::int16_t>(value)});
    return is_done;
  } else {
    const bool is_done = core.load<std::uint8_t>(address, value);
    value = static_cast<std::uint32_t>(std::int32_t{static_cast<std::int8_t>(value)});
    return is_done;
  }
}

template <Type type>
[[nodiscard]] bool store(Core& core, std::uint32_t address, std::uint32_t value) {
  if constexpr (type == Type::word) {
    return core.store<std::uint32_t>(address, value);
  } else if constexpr (type == Type::half) {
    return core.store<std::uint16_t>(address, value);
  } else {
    return core.store<std::uint8_t>(address, value);
  }
}

/// The address: the base plus a constant; plus a register that is shifted by `amount`; an absolute one (PC); the base,
/// to which the constant is added afterwards; or is added first, and the sum is kept.
enum class Mode : std::uint8_t { offset, indexed, absolute, post_indexed, pre_indexed };

template <Mode mode>
std::uint32_t address_of(const Core& core, const Instruction& instruction) {
  if constexpr (mode == Mode::indexed) {
    return core.r[instruction.n] + (core.r[instruction.m] << instruction.amount);
  } else if constexpr (mode == Mode::absolute) {
    return instruction.immediate;
  } else if constexpr (mode == Mode::post_indexed) {
    return core.r[instruction.n];
  } else {
    return core.r[instruction.n] + instruction.immediate;
  }
}

template <Mode mode>
void write_back(Core& core, const Instruction& instruction) {
  if constexpr (mode == Mode::post_indexed || mode == Mode::pre_indexed) {
    core.set(instruction.n, core.r[instruction.n] + instruction.immediate);
  }
}

inline constexpr std::size_t type_count = 5;
inline constexpr std::size_t mode_count = 5;
/// For tables of functions by mode.
inline constexpr auto modes = std::make_index_sequence<mode_count>();

}  // namespace proleg::sim::transfer
