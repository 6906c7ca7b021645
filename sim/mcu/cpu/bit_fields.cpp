// Fields of a register, saturation, and halves of two registers in one.

#include <algorithm>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"
#include "sim/mcu/cpu/shifts.hpp"

namespace proleg::sim {
namespace {

/// PKHBT and PKHTB.
template <bool is_top>
const Instruction* pack_halves(Core& core, const Instruction& instruction) {
  const std::uint32_t a = core.r[instruction.n];
  const std::uint32_t b = shifted(core.r[instruction.m], instruction.shift, instruction.amount, 0).value;
  core.r[instruction.d] = is_top ? (a & 0xFFFF'0000U) | (b & 0xFFFFU) : (a & 0xFFFFU) | (b & 0xFFFF'0000U);
  return core.go_on(after(instruction));
}

/// SSAT and USAT (bit 0 of the option: unsigned); the immediate is the number of bits.
const Instruction* saturate(Core& core, const Instruction& instruction) {
  const auto value =
      static_cast<std::int32_t>(shifted(core.r[instruction.n], instruction.shift, instruction.amount, 0).value);
  const std::int64_t highest = (std::int64_t{1} << instruction.immediate) - 1;
  const std::int64_t lowest = instruction.option != 0 ? 0 : -highest - 1;
  const std::int64_t limited = std::clamp<std::int64_t>(value, lowest, highest);
  core.saturated = core.saturated || limited != value;
  core.r[instruction.d] = static_cast<std::uint32_t>(limited);
  return core.go_on(after(instruction));
}

/// SSAT16 and USAT16.
const Instruction* saturate_halves(Core& core, const Instruction& instruction) {
  const std::uint32_t values = core.r[instruction.n];
  const std::int32_t highest = (std::int32_t{1} << instruction.immediate) - 1;
  const std::int32_t lowest = instruction.option != 0 ? 0 : -highest - 1;
  std::uint32_t result = 0;
  for (unsigned half = 0; half < 2; ++half) {
    const std::int32_t value = static_cast<std::int16_t>(values >> 16U * half);
    const std::int32_t limited = std::clamp(value, lowest, highest);
    core.saturated = core.saturated || limited != value;
    result |= (static_cast<std::uint32_t>(limited) & 0xFFFFU) << 16U * half;
  }
  core.r[instruction.d] = result;
  return core.go_on(after(instruction));
}

/// SBFX and UBFX: the field begins at bit `amount` and has `option` bits.
template <bool is_signed>
const Instruction* extract_field(Core& core, const Instruction& instruction) {
  const std::uint32_t on_top = core.r[instruction.n] << (32U - instruction.amount - instruction.option);
  const unsigned shift = 32U - instruction.option;
  core.r[instruction.d] =
      is_signed ? static_cast<std::uint32_t>(static_cast<std::int32_t>(on_top) >> shift) : on_top >> shift;
  return core.go_on(after(instruction));
}

/// BFI and BFC (n is the PC): the field of the mask `immediate` begins at bit `amount`.
const Instruction* insert_field(Core& core, const Instruction& instruction) {
  const std::uint32_t field = instruction.n == program_counter ? 0U : core.r[instruction.n] << instruction.amount;
  core.r[instruction.d] = (core.r[instruction.d] & ~instruction.immediate) | (field & instruction.immediate);
  return core.go_on(after(instruction));
}

Instruction saturation(const Encoding& code) {
  Instruction instruction;
  instruction.d = code.more_reg(8);
  instruction.n = code.reg(0, 4);
  const bool is_unsigned = code.bits(7) != 0;
  const unsigned amount = code.more(12, 3) << 2U | code.more(6, 2);
  const bool is_right_shift = code.bits(5) != 0;
  const bool is_of_halves = is_right_shift && amount == 0;
  instruction.option = is_unsigned ? 1 : 0;
  instruction.immediate = code.more(0, 5);
  instruction.shift = is_right_shift ? Shift::asr : Shift::lsl;
  instruction.amount = static_cast<std::uint8_t>(amount);
  const bool is_valid = code.bits(10) == 0 && code.more(5) == 0 && !is_sp_or_pc(instruction.d) &&
                        !is_sp_or_pc(instruction.n) && (!is_of_halves || code.more(4) == 0);
  if (is_valid) {
    instruction.execute = is_of_halves ? &saturate_halves : &saturate;
  }
  return instruction;
}

Instruction bit_field(const Encoding& code) {
  Instruction instruction;
  instruction.d = code.more_reg(8);
  instruction.n = code.reg(0, 4);
  const unsigned lowest = code.more(12, 3) << 2U | code.more(6, 2);
  const unsigned last = code.more(0, 5);
  instruction.amount = static_cast<std::uint8_t>(lowest);
  if (code.bits(10) != 0 || code.more(5) != 0 || is_sp_or_pc(instruction.d) || instruction.n == stack_pointer) {
    return instruction;
  }
  if (code.bits(5, 2) == 3) {  // BFI, BFC
    if (last >= lowest) {
      instruction.immediate = (last == 31 ? ~0U : (1U << (last + 1)) - 1U) & ~((1U << lowest) - 1U);
      instruction.execute = &insert_field;
    }
    return instruction;
  }
  if (instruction.n != program_counter && lowest + last < 32) {
    instruction.option = static_cast<std::uint8_t>(last + 1);
    instruction.execute = code.bits(7) != 0 ? &extract_field<false> : &extract_field<true>;
  }
  return instruction;
}

}  // namespace

Instruction decode_packing(const Encoding& code) {
  Instruction instruction;
  instruction.d = code.more_reg(8);
  instruction.n = code.reg(0, 4);
  instruction.m = code.more_reg(0);
  set_shift(instruction, code);
  const bool is_valid = code.bits(4) == 0 && code.more(4) == 0 && !is_sp_or_pc(instruction.d) &&
                        !is_sp_or_pc(instruction.n) && !is_sp_or_pc(instruction.m);
  if (is_valid) {
    instruction.execute = code.more(5) == 0 ? &pack_halves<false> : &pack_halves<true>;
  }
  return instruction;
}

Instruction decode_saturation_or_field(const Encoding& code) {
  switch (code.bits(4, 5)) {
    case 0b10000:
    case 0b10010:
    case 0b11000:
    case 0b11010:
      return saturation(code);
    case 0b10100:
    case 0b10110:
    case 0b11100:
      return bit_field(code);
    default:
      return {};
  }
}

}  // namespace proleg::sim
