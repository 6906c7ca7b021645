#pragma once

// An instruction of the Cortex-M4 as it is executed: decoded once, with the function that does its work.

#include <cstdint>
#include <span>

namespace proleg::sim {

class Core;
struct Instruction;

/// Executes an instruction, and those behind it (Core::go_on()). Returns the one that follows; the same one if it was
/// not executed, and Core::end says why.
using Execute = const Instruction* (*)(Core& core, const Instruction& instruction);

/// Numbers of registers that have a name.
inline constexpr unsigned stack_pointer = 13;
inline constexpr unsigned link_register = 14;
inline constexpr unsigned program_counter = 15;
[[nodiscard]] inline bool is_sp_or_pc(unsigned number) { return number == stack_pointer || number == program_counter; }

/// How the second operand is shifted (DDI 0403, A7.4).
enum class Shift : std::uint8_t { lsl, lsr, asr, ror, rrx };

/// The instruction behind one of n halfwords stands n places behind it. What a field means is said where the
/// instruction is decoded; a name is that of the manual's pseudocode.
struct Instruction {
  Execute execute = nullptr;
  Execute conditional = nullptr;  ///< in an IT block: what `execute` calls if the condition holds
  std::uint32_t address = 0;
  std::uint32_t immediate = 0;
  std::uint8_t d = 0;  ///< destination register; RdLo
  std::uint8_t n = 0;  ///< first operand; base of an address
  std::uint8_t m = 0;  ///< second operand; offset of an address
  std::uint8_t a = 0;  ///< third operand; RdHi; second register of a pair
  std::uint8_t halfwords = 1;
  Shift shift = Shift::lsl;
  std::uint8_t amount = 0;  ///< of the shift
  std::uint8_t option = 0;
};

/// The one behind it in memory.
[[nodiscard]] inline const Instruction* after(const Instruction& instruction) {
  return &instruction + instruction.halfwords;
}

/// Of a jump whose target stands beside it: `immediate` is the distance in halfwords.
[[nodiscard]] inline const Instruction* near_target(const Instruction& jump) {
  return &jump + static_cast<std::int32_t>(jump.immediate);
}

/// The halfwords to be decoded.
struct Encoding {
  std::uint32_t address = 0;
  std::uint16_t first = 0;
  std::uint16_t second = 0;  ///< counts for instructions of four bytes
  bool in_it_block = false;
  /// Of an instruction in a CodePage: where the page begins, and what it depends on.
  std::uint32_t page = 0;
  std::span<const std::uint8_t> memory;

  [[nodiscard]] bool is_in_page() const { return !memory.empty(); }
  /// Bits of the first halfword; of the second.
  [[nodiscard]] unsigned bits(unsigned lowest, unsigned width = 1) const {
    return first >> lowest & ((1U << width) - 1U);
  }
  [[nodiscard]] unsigned more(unsigned lowest, unsigned width = 1) const {
    return second >> lowest & ((1U << width) - 1U);
  }
  [[nodiscard]] std::uint8_t reg(unsigned lowest, unsigned width = 3) const {
    return static_cast<std::uint8_t>(bits(lowest, width));
  }
  [[nodiscard]] std::uint8_t more_reg(unsigned lowest) const { return static_cast<std::uint8_t>(more(lowest, 4)); }
  /// PC as an operand.
  [[nodiscard]] std::uint32_t pc() const { return address + 4; }
};

/// What makes instructions. The state on which they work has it from its owner, since they need that state.
struct InstructionSet {
  /// What the halfwords at an address say.
  Instruction (*decode)(const Encoding& code);
  /// How the first of two instructions is executed together with the one behind it; null: each alone.
  Execute (*joined)(const Instruction& first, const Instruction& second);
  /// Not an instruction: leads to the one at the address, behind the last that was decoded.
  Instruction (*continuation)(std::uint32_t address);
  /// In place of an instruction at an address without memory.
  Instruction (*fetch_fault)(std::uint32_t address);
  /// In place of the instruction at the target of a branch that cleared EPSR.T.
  Instruction (*invalid_state)(std::uint32_t address);
};

}  // namespace proleg::sim
