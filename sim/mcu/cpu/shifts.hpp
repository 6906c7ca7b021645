#pragma once

// Shifted operands (DDI 0403, A7.4).

#include <bit>
#include <cstdint>

#include "sim/mcu/cpu/instruction.hpp"

namespace proleg::sim {

struct Shifted {
  std::uint32_t value;
  std::uint32_t carry;  ///< 0 or 1
};

/// amount: 0 to 255; no matter for rrx. carry: the flag before.
[[nodiscard]] inline Shifted shifted(std::uint32_t value, Shift shift, unsigned amount, std::uint32_t carry) {
  if (shift == Shift::rrx) {
    return {carry << 31U | value >> 1U, value & 1U};
  }
  if (amount == 0) {
    return {value, carry};
  }
  switch (shift) {
    case Shift::lsl:
      return amount < 32 ? Shifted{value << amount, value >> (32 - amount) & 1U}
                         : Shifted{0, amount == 32 ? value & 1U : 0U};
    case Shift::lsr:
      return amount < 32 ? Shifted{value >> amount, value >> (amount - 1) & 1U}
                         : Shifted{0, amount == 32 ? value >> 31U : 0U};
    case Shift::asr: {
      const std::uint32_t sign = 0U - (value >> 31U);
      return amount < 32 ? Shifted{static_cast<std::uint32_t>(static_cast<std::int32_t>(value) >> amount),
                                   value >> (amount - 1) & 1U}
                         : Shifted{sign, sign & 1U};
    }
    default: {
      const std::uint32_t rotated = std::rotr(value, static_cast<int>(amount % 32));
      return {rotated, rotated >> 31U};
    }
  }
}

/// Sets shift and amount from the two bits of the type and the five of the constant (DDI 0403, A7.4.2).
inline void set_constant_shift(Instruction& instruction, unsigned type, unsigned constant) {
  instruction.shift = type == 3 && constant == 0 ? Shift::rrx : static_cast<Shift>(type);
  instruction.amount = static_cast<std::uint8_t>(constant == 0 && (type == 1 || type == 2) ? 32 : constant);
}

/// The two bits of the type and the five of the constant of a shift.
inline void set_shift(Instruction& instruction, const Encoding& code) {
  set_constant_shift(instruction, code.more(4, 2), code.more(12, 3) << 2U | code.more(6, 2));
}

}  // namespace proleg::sim
