// Multiplications and divisions.

#include <limits>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"

namespace proleg::sim {
namespace {

std::int64_t as_signed(std::uint32_t value) { return static_cast<std::int32_t>(value); }
std::int64_t half(std::uint32_t value, bool is_top) { return static_cast<std::int16_t>(is_top ? value >> 16U : value); }

/// MUL of two bytes.
template <bool sets_flags>
const Instruction* multiply(Core& core, const Instruction& instruction) {
  const std::uint32_t product = core.r[instruction.n] * core.r[instruction.m];
  if constexpr (sets_flags) {
    core.set_negative_and_zero(product);
  }
  core.r[instruction.d] = product;
  return core.go_on(after(instruction));
}

/// MLA; MUL of four bytes, whose a is the PC.
const Instruction* multiply_and_add(Core& core, const Instruction& instruction) {
  const std::uint32_t summand = instruction.a == program_counter ? 0U : core.r[instruction.a];
  core.r[instruction.d] = core.r[instruction.n] * core.r[instruction.m] + summand;
  return core.go_on(after(instruction));
}

/// MLS.
const Instruction* multiply_and_subtract(Core& core, const Instruction& instruction) {
  core.r[instruction.d] = core.r[instruction.a] - core.r[instruction.n] * core.r[instruction.m];
  return core.go_on(after(instruction));
}

/// Adds a, unless it is the PC. Sets Q if the sum is no word.
void accumulate(Core& core, const Instruction& instruction, std::int64_t value) {
  const std::int64_t sum = value + (instruction.a == program_counter ? 0 : as_signed(core.r[instruction.a]));
  core.saturated = core.saturated || sum > std::numeric_limits<std::int32_t>::max() ||
                   sum < std::numeric_limits<std::int32_t>::min();
  core.r[instruction.d] = static_cast<std::uint32_t>(sum);
}

// Instruction::option: bits 4 and 5 of the second halfword.

/// SMLABB, SMULBB and the like.
const Instruction* multiply_halves(Core& core, const Instruction& instruction) {
  accumulate(core, instruction,
             half(core.r[instruction.n], (instruction.option & 2U) != 0) *
                 half(core.r[instruction.m], (instruction.option & 1U) != 0));
  return core.go_on(after(instruction));
}

/// SMLAWB, SMULWB and the like.
const Instruction* multiply_word_by_half(Core& core, const Instruction& instruction) {
  accumulate(core, instruction,
             as_signed(core.r[instruction.n]) * half(core.r[instruction.m], (instruction.option & 1U) != 0) >> 16);
  return core.go_on(after(instruction));
}

struct Products {
  std::int64_t low;
  std::int64_t high;
};

/// Of both halves, those of m exchanged if bit 0 of the option is set.
Products products_of_halves(const Core& core, const Instruction& instruction) {
  const bool exchanges = (instruction.option & 1U) != 0;
  const std::uint32_t a = core.r[instruction.n];
  const std::uint32_t b = core.r[instruction.m];
  return {half(a, false) * half(b, exchanges), half(a, true) * half(b, !exchanges)};
}

/// SMLAD, SMUAD, SMLSD, SMUSD.
template <bool subtracts>
const Instruction* multiply_both_halves(Core& core, const Instruction& instruction) {
  const Products products = products_of_halves(core, instruction);
  accumulate(core, instruction, subtracts ? products.low - products.high : products.low + products.high);
  return core.go_on(after(instruction));
}

/// SMMLA, SMMUL, SMMLS; bit 0 of the option: rounded.
template <bool subtracts>
const Instruction* multiply_for_top(Core& core, const Instruction& instruction) {
  const auto product = static_cast<std::uint64_t>(as_signed(core.r[instruction.n]) * as_signed(core.r[instruction.m]));
  const std::uint64_t summand = instruction.a == program_counter ? 0U : std::uint64_t{core.r[instruction.a]} << 32U;
  const std::uint64_t rounding = (instruction.option & 1U) != 0 ? 0x8000'0000U : 0U;
  core.r[instruction.d] =
      static_cast<std::uint32_t>(((subtracts ? summand - product : summand + product) + rounding) >> 32U);
  return core.go_on(after(instruction));
}

/// USADA8, USAD8.
const Instruction* sum_of_differences(Core& core, const Instruction& instruction) {
  std::uint32_t sum = instruction.a == program_counter ? 0U : core.r[instruction.a];
  for (unsigned at = 0; at < 32; at += 8) {
    const std::uint32_t a = core.r[instruction.n] >> at & 0xFFU;
    const std::uint32_t b = core.r[instruction.m] >> at & 0xFFU;
    sum += a > b ? a - b : b - a;
  }
  core.r[instruction.d] = sum;
  return core.go_on(after(instruction));
}

// Results of two words: d has the low one, a the high one.

std::uint64_t pair(const Core& core, const Instruction& instruction) {
  return std::uint64_t{core.r[instruction.a]} << 32U | core.r[instruction.d];
}

const Instruction* set_pair(Core& core, const Instruction& instruction, std::uint64_t value) {
  core.r[instruction.d] = static_cast<std::uint32_t>(value);
  core.r[instruction.a] = static_cast<std::uint32_t>(value >> 32U);
  return core.go_on(after(instruction));
}

/// SMULL, SMLAL.
template <bool adds>
const Instruction* multiply_signed(Core& core, const Instruction& instruction) {
  const auto product = static_cast<std::uint64_t>(as_signed(core.r[instruction.n]) * as_signed(core.r[instruction.m]));
  return set_pair(core, instruction, product + (adds ? pair(core, instruction) : 0U));
}

/// UMULL, UMLAL.
template <bool adds>
const Instruction* multiply_unsigned(Core& core, const Instruction& instruction) {
  const std::uint64_t product = std::uint64_t{core.r[instruction.n]} * core.r[instruction.m];
  return set_pair(core, instruction, product + (adds ? pair(core, instruction) : 0U));
}

/// UMAAL.
const Instruction* multiply_and_add_both(Core& core, const Instruction& instruction) {
  return set_pair(
      core, instruction,
      std::uint64_t{core.r[instruction.n]} * core.r[instruction.m] + core.r[instruction.a] + core.r[instruction.d]);
}

/// SMLALBB and the like.
const Instruction* multiply_halves_long(Core& core, const Instruction& instruction) {
  const std::int64_t product = half(core.r[instruction.n], (instruction.option & 2U) != 0) *
                               half(core.r[instruction.m], (instruction.option & 1U) != 0);
  return set_pair(core, instruction, pair(core, instruction) + static_cast<std::uint64_t>(product));
}

/// SMLALD, SMLSLD.
template <bool subtracts>
const Instruction* multiply_both_halves_long(Core& core, const Instruction& instruction) {
  const Products products = products_of_halves(core, instruction);
  const std::int64_t sum = subtracts ? products.low - products.high : products.low + products.high;
  return set_pair(core, instruction, pair(core, instruction) + static_cast<std::uint64_t>(sum));
}

template <bool is_signed>
const Instruction* divide(Core& core, const Instruction& instruction) {
  const std::uint32_t dividend = core.r[instruction.n];
  const std::uint32_t divisor = core.r[instruction.m];
  if (divisor == 0) {
    if (core.traps_division) {
      return core.finish(End::divide_by_zero, &instruction);
    }
    core.r[instruction.d] = 0;
  } else {
    core.r[instruction.d] =
        is_signed ? static_cast<std::uint32_t>(as_signed(dividend) / as_signed(divisor)) : dividend / divisor;
  }
  return core.go_on(after(instruction));
}

}  // namespace

Instruction decode_narrow_multiplication(const Encoding& code) {
  Instruction instruction;
  instruction.d = instruction.m = code.reg(0);
  instruction.n = code.reg(3);
  if (code.first >> 6U == 0b0100001101) {
    instruction.execute = code.in_it_block ? &multiply<false> : &multiply<true>;
  }
  return instruction;
}

Instruction decode_multiplication(const Encoding& code) {
  Instruction instruction;
  instruction.n = code.reg(0, 4);
  instruction.m = code.more_reg(0);
  instruction.d = code.more_reg(8);
  instruction.a = code.more_reg(12);
  instruction.option = static_cast<std::uint8_t>(code.more(4, 2));
  if (code.more(6, 2) != 0 || is_sp_or_pc(instruction.d) || is_sp_or_pc(instruction.n) || is_sp_or_pc(instruction.m) ||
      instruction.a == stack_pointer) {
    return instruction;
  }
  const bool has_no_summand = instruction.a == program_counter;
  switch (code.bits(4, 3)) {
    case 0:
      if (instruction.option == 0) {
        instruction.execute = &multiply_and_add;
      } else if (instruction.option == 1 && !has_no_summand) {
        instruction.execute = &multiply_and_subtract;
      }
      break;
    case 1:
      instruction.execute = &multiply_halves;
      break;
    case 2:
      instruction.execute = instruction.option < 2 ? &multiply_both_halves<false> : nullptr;
      break;
    case 3:
      instruction.execute = instruction.option < 2 ? &multiply_word_by_half : nullptr;
      break;
    case 4:
      instruction.execute = instruction.option < 2 ? &multiply_both_halves<true> : nullptr;
      break;
    case 5:
      instruction.execute = instruction.option < 2 ? &multiply_for_top<false> : nullptr;
      break;
    case 6:
      instruction.execute = instruction.option < 2 && !has_no_summand ? &multiply_for_top<true> : nullptr;
      break;
    default:
      instruction.execute = instruction.option == 0 ? &sum_of_differences : nullptr;
      break;
  }
  return instruction;
}

Instruction decode_long_multiplication(const Encoding& code) {
  Instruction instruction;
  instruction.n = code.reg(0, 4);
  instruction.m = code.more_reg(0);
  const unsigned group = code.bits(4, 3);
  const unsigned operation = code.more(4, 4);
  if (is_sp_or_pc(instruction.n) || is_sp_or_pc(instruction.m) || is_sp_or_pc(code.more(8, 4))) {
    return instruction;
  }
  if (group == 1 || group == 3) {
    instruction.d = code.more_reg(8);
    if (operation == 0xF && code.more(12, 4) == 0xF) {
      instruction.execute = group == 1 ? &divide<true> : &divide<false>;
    }
    return instruction;
  }
  instruction.d = code.more_reg(12);
  instruction.a = code.more_reg(8);
  instruction.option = static_cast<std::uint8_t>(operation & 3U);
  if (is_sp_or_pc(instruction.d) || instruction.d == instruction.a) {
    return instruction;
  }
  if (group == 0 && operation == 0) {
    instruction.execute = &multiply_signed<false>;
  } else if (group == 2 && operation == 0) {
    instruction.execute = &multiply_unsigned<false>;
  } else if (group == 4 && operation == 0) {
    instruction.execute = &multiply_signed<true>;
  } else if (group == 4 && operation >> 2U == 2) {
    instruction.execute = &multiply_halves_long;
  } else if (group == 4 && operation >> 1U == 6) {
    instruction.execute = &multiply_both_halves_long<false>;
  } else if (group == 5 && operation >> 1U == 6) {
    instruction.execute = &multiply_both_halves_long<true>;
  } else if (group == 6 && operation == 0) {
    instruction.execute = &multiply_unsigned<true>;
  } else if (group == 6 && operation == 6) {
    instruction.execute = &multiply_and_add_both;
  }
  return instruction;
}

}  // namespace proleg::sim
