// Shifts by a register, extensions, sums of halves and bytes, and other instructions whose operands are registers only.

#include <algorithm>
#include <bit>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"
#include "sim/mcu/cpu/shifts.hpp"

namespace proleg::sim {
namespace {

template <bool sets_flags>
const Instruction* shift(Core& core, const Instruction& instruction) {
  const Shifted result = shifted(core.r[instruction.n], instruction.shift, core.r[instruction.m] & 0xFFU, core.carry);
  if constexpr (sets_flags) {
    core.set_negative_and_zero(result.value);
    core.carry = result.carry;
  }
  core.r[instruction.d] = result.value;
  return core.go_on(after(instruction));
}

/// Instruction::amount: by how many bits the register is rotated first.
std::uint32_t rotated(const Core& core, const Instruction& instruction) {
  return std::rotr(core.r[instruction.m], instruction.amount);
}

std::uint32_t added(const Core& core, const Instruction& instruction, std::uint32_t value) {
  return instruction.n == program_counter ? value : core.r[instruction.n] + value;
}

/// SXTB, SXTH, UXTB, UXTH, and with a sum (n is not the PC) SXTAB, SXTAH, UXTAB, UXTAH.
template <typename Narrow>
const Instruction* extend(Core& core, const Instruction& instruction) {
  const auto narrow = static_cast<Narrow>(rotated(core, instruction));
  core.r[instruction.d] = added(core, instruction, static_cast<std::uint32_t>(std::int32_t{narrow}));
  return core.go_on(after(instruction));
}

/// SXTB16, UXTB16, SXTAB16, UXTAB16.
template <typename Narrow>
const Instruction* extend_both(Core& core, const Instruction& instruction) {
  const std::uint32_t value = rotated(core, instruction);
  const std::uint32_t base = instruction.n == program_counter ? 0U : core.r[instruction.n];
  const auto low = static_cast<std::uint32_t>(std::int32_t{static_cast<Narrow>(value)});
  const auto high = static_cast<std::uint32_t>(std::int32_t{static_cast<Narrow>(value >> 16U)});
  core.r[instruction.d] = ((base + low) & 0xFFFFU) | ((base >> 16U) + high) << 16U;
  return core.go_on(after(instruction));
}

/// Sums and differences of halves or bytes. Instruction::option: bits 0 to 2 the operation, 3 and 4 the limit of the
/// results, 5 unsigned.
enum class Lanes : std::uint8_t {
  add_bytes = 0,
  add_halves = 1,
  add_subtract = 2,
  subtract_bytes = 4,
  subtract_halves = 5,
  subtract_add = 6
};
enum class Limit : std::uint8_t { wraps = 0, saturates = 1, halves = 2 };

struct Lane {
  std::uint32_t bits;
  bool greater_equal;
};

Lane lane_of(std::int32_t a, std::int32_t b, bool subtracts, unsigned width, bool is_unsigned, Limit limit) {
  const std::int32_t result = subtracts ? a - b : a + b;
  const std::int32_t range = std::int32_t{1} << width;
  const std::int32_t lowest = is_unsigned ? 0 : -range / 2;
  const bool greater_equal = is_unsigned && !subtracts ? result >= range : result >= 0;
  std::int32_t limited = result;
  if (limit == Limit::saturates) {
    limited = std::clamp(result, lowest, lowest + range - 1);
  } else if (limit == Limit::halves) {
    limited = result >> 1;
  }
  return {static_cast<std::uint32_t>(limited) & (static_cast<std::uint32_t>(range) - 1U), greater_equal};
}

const Instruction* compute_lanes(Core& core, const Instruction& instruction) {
  const auto operation = static_cast<Lanes>(instruction.option & 7U);
  const auto limit = static_cast<Limit>(instruction.option >> 3U & 3U);
  const bool is_unsigned = instruction.option >> 5U != 0;
  const std::uint32_t a = core.r[instruction.n];
  const std::uint32_t b = core.r[instruction.m];
  const bool is_of_bytes = operation == Lanes::add_bytes || operation == Lanes::subtract_bytes;
  const bool crosses = operation == Lanes::add_subtract || operation == Lanes::subtract_add;
  const unsigned width = is_of_bytes ? 8 : 16;
  std::uint32_t result = 0;
  std::uint8_t flags = 0;
  for (unsigned at = 0; at < 32; at += width) {
    const unsigned other = crosses ? 16 - at : at;
    const bool is_high = at != 0;
    const bool subtracts = operation == Lanes::subtract_bytes || operation == Lanes::subtract_halves ||
                           (operation == Lanes::add_subtract && !is_high) ||
                           (operation == Lanes::subtract_add && is_high);
    const auto part = [&](std::uint32_t value, unsigned shift) {
      const std::uint32_t bits = value >> shift & ((1U << width) - 1U);
      const std::uint32_t sign = is_unsigned ? 0U : bits & 1U << (width - 1);
      return static_cast<std::int32_t>(bits - 2 * sign);
    };
    const Lane lane = lane_of(part(a, at), part(b, other), subtracts, width, is_unsigned, limit);
    result |= lane.bits << at;
    if (lane.greater_equal) {
      flags = static_cast<std::uint8_t>(flags | (is_of_bytes ? 1U : 3U) << at / 8);
    }
  }
  core.r[instruction.d] = result;
  if (limit == Limit::wraps) {
    core.greater_equal = flags;
  }
  return core.go_on(after(instruction));
}

std::int64_t saturated(Core& core, std::int64_t value) {
  const std::int64_t limited = std::clamp<std::int64_t>(value, INT32_MIN, INT32_MAX);
  core.saturated = core.saturated || limited != value;
  return limited;
}

/// QADD, QSUB, QDADD, QDSUB: a sum or difference of m and n, which is doubled first.
template <bool doubles, bool subtracts>
const Instruction* saturating_sum(Core& core, const Instruction& instruction) {
  const std::int64_t a = static_cast<std::int32_t>(core.r[instruction.m]);
  std::int64_t b = static_cast<std::int32_t>(core.r[instruction.n]);
  if constexpr (doubles) {
    b = saturated(core, 2 * b);
  }
  core.r[instruction.d] = static_cast<std::uint32_t>(saturated(core, subtracts ? a - b : a + b));
  return core.go_on(after(instruction));
}

std::uint32_t reversed_bytes(std::uint32_t value) { return __builtin_bswap32(value); }

const Instruction* reverse_bytes(Core& core, const Instruction& instruction) {
  core.r[instruction.d] = reversed_bytes(core.r[instruction.m]);
  return core.go_on(after(instruction));
}

const Instruction* reverse_bytes_of_halves(Core& core, const Instruction& instruction) {
  core.r[instruction.d] = std::rotl(reversed_bytes(core.r[instruction.m]), 16);
  return core.go_on(after(instruction));
}

const Instruction* reverse_signed_half(Core& core, const Instruction& instruction) {
  const auto half = static_cast<std::int16_t>(reversed_bytes(core.r[instruction.m]) >> 16U);
  core.r[instruction.d] = static_cast<std::uint32_t>(std::int32_t{half});
  return core.go_on(after(instruction));
}

const Instruction* reverse_bits(Core& core, const Instruction& instruction) {
  std::uint32_t value = core.r[instruction.m];
  value = (value >> 1U & 0x5555'5555U) | (value & 0x5555'5555U) << 1U;
  value = (value >> 2U & 0x3333'3333U) | (value & 0x3333'3333U) << 2U;
  value = (value >> 4U & 0x0F0F'0F0FU) | (value & 0x0F0F'0F0FU) << 4U;
  core.r[instruction.d] = reversed_bytes(value);
  return core.go_on(after(instruction));
}

const Instruction* select_bytes(Core& core, const Instruction& instruction) {
  std::uint32_t mask = 0;
  for (unsigned byte = 0; byte < 4; ++byte) {
    mask |= (core.greater_equal >> byte & 1U) != 0 ? 0xFFU << 8U * byte : 0U;
  }
  core.r[instruction.d] = (core.r[instruction.n] & mask) | (core.r[instruction.m] & ~mask);
  return core.go_on(after(instruction));
}

const Instruction* count_leading_zeros(Core& core, const Instruction& instruction) {
  core.r[instruction.d] = static_cast<std::uint32_t>(std::countl_zero(core.r[instruction.m]));
  return core.go_on(after(instruction));
}

Instruction registers_of(const Encoding& code) {
  Instruction instruction;
  instruction.d = code.more_reg(8);
  instruction.n = code.reg(0, 4);
  instruction.m = code.more_reg(0);
  return instruction;
}

Execute extension(unsigned operation) {
  switch (operation) {
    case 0:
      return &extend<std::int16_t>;
    case 1:
      return &extend<std::uint16_t>;
    case 2:
      return &extend_both<std::int8_t>;
    case 3:
      return &extend_both<std::uint8_t>;
    case 4:
      return &extend<std::int8_t>;
    case 5:
      return &extend<std::uint8_t>;
    default:
      return nullptr;
  }
}

/// A5.3.13 and A5.3.14.
Execute lanes(unsigned operation, unsigned limit) {
  const bool is_known = (operation != 3 && operation != 7) && limit != 3;
  return is_known ? &compute_lanes : nullptr;
}

/// A5.3.15.
Execute miscellaneous(unsigned group, unsigned operation) {
  switch (group << 2U | operation) {
    case 0:
      return &saturating_sum<false, false>;
    case 1:
      return &saturating_sum<true, false>;
    case 2:
      return &saturating_sum<false, true>;
    case 3:
      return &saturating_sum<true, true>;
    case 4:
      return &reverse_bytes;
    case 5:
      return &reverse_bytes_of_halves;
    case 6:
      return &reverse_bits;
    case 7:
      return &reverse_signed_half;
    case 8:
      return &select_bytes;
    case 12:
      return &count_leading_zeros;
    default:
      return nullptr;
  }
}

}  // namespace

Instruction decode_register_processing(const Encoding& code) {
  Instruction instruction = registers_of(code);
  const unsigned group = code.bits(4, 4);
  const unsigned operation = code.more(4, 4);
  if (code.more(12, 4) != 0xF || is_sp_or_pc(instruction.d) || is_sp_or_pc(instruction.m) ||
      instruction.n == stack_pointer) {
    return {};
  }
  if (group < 8 && operation >= 8) {
    instruction.amount = static_cast<std::uint8_t>(8 * code.more(4, 2));
    instruction.execute = code.more(6) == 0 ? extension(group) : nullptr;
    return instruction;
  }
  if (instruction.n == program_counter) {
    return {};
  }
  if (group < 8 && operation == 0) {
    instruction.shift = static_cast<Shift>(group >> 1U);
    instruction.execute = (group & 1U) != 0 ? &shift<true> : &shift<false>;
  } else if (group >= 8 && operation < 8) {
    instruction.option = static_cast<std::uint8_t>((group & 7U) | operation << 3U);
    instruction.execute = lanes(group & 7U, operation & 3U);
  } else if (group >= 8 && group < 12 && operation < 12) {
    const bool has_one_operand = group == 9 || group == 11;
    instruction.execute =
        !has_one_operand || instruction.n == instruction.m ? miscellaneous(group & 3U, operation & 3U) : nullptr;
  }
  return instruction;
}

Instruction decode_narrow_register_processing(const Encoding& code) {
  Instruction instruction;
  instruction.d = code.reg(0);
  instruction.m = code.reg(3);
  instruction.n = program_counter;
  const auto with_shift = [&](Shift type) {
    instruction.n = instruction.d;
    instruction.shift = type;
    instruction.execute = code.in_it_block ? &shift<false> : &shift<true>;
  };
  switch (code.first >> 6U) {
    case 0b0100000010:
      with_shift(Shift::lsl);
      break;
    case 0b0100000011:
      with_shift(Shift::lsr);
      break;
    case 0b0100000100:
      with_shift(Shift::asr);
      break;
    case 0b0100000111:
      with_shift(Shift::ror);
      break;
    case 0b1011001000:
      instruction.execute = extension(0);
      break;
    case 0b1011001001:
      instruction.execute = extension(4);
      break;
    case 0b1011001010:
      instruction.execute = extension(1);
      break;
    case 0b1011001011:
      instruction.execute = extension(5);
      break;
    case 0b1011101000:
      instruction.execute = &reverse_bytes;
      break;
    case 0b1011101001:
      instruction.execute = &reverse_bytes_of_halves;
      break;
    case 0b1011101011:
      instruction.execute = &reverse_signed_half;
      break;
    default:
      break;
  }
  return instruction;
}

}  // namespace proleg::sim
