#pragma once

// The instruction set of the Cortex-M4 without its FPU (ARMv7-M Architecture Reference Manual, DDI 0403, A5 and A7).
// The files that decode a group of instructions also say what they do.

#include <cstdint>
#include <optional>

#include "sim/mcu/cpu/instruction.hpp"

namespace proleg::sim {

/// What the manual calls UNPREDICTABLE is an undefined instruction, too.
extern const InstructionSet thumb_instructions;

/// Executes hints, barriers and preloads: nothing.
[[nodiscard]] const Instruction* do_nothing(Core& core, const Instruction& instruction);

// The groups. Instruction::execute is null if the encoding is not theirs.

/// Shifts, sums, comparisons and logic of two bytes (A5.2.1 to A5.2.3), and adding to SP or PC.
[[nodiscard]] Instruction decode_narrow_data_processing(const Encoding& code);
/// The same of four bytes: with a shifted register (A5.3.11), a modified constant (A5.3.1) or a plain constant
/// (A5.3.3).
[[nodiscard]] Instruction decode_shifted_register(const Encoding& code);
[[nodiscard]] Instruction decode_modified_constant(const Encoding& code);
[[nodiscard]] Instruction decode_plain_constant(const Encoding& code);
/// Of these, halves of two registers in one; saturation and fields of a register.
[[nodiscard]] Instruction decode_packing(const Encoding& code);
[[nodiscard]] Instruction decode_saturation_or_field(const Encoding& code);
/// Shifts by a register, extensions, sums of halves and bytes, and others of registers (A5.3.12 to A5.3.15), and those
/// of two bytes.
[[nodiscard]] Instruction decode_register_processing(const Encoding& code);
[[nodiscard]] Instruction decode_narrow_register_processing(const Encoding& code);
/// MUL of two bytes; multiplications and divisions of four bytes (A5.3.16, A5.3.17).
[[nodiscard]] Instruction decode_narrow_multiplication(const Encoding& code);
[[nodiscard]] Instruction decode_multiplication(const Encoding& code);
[[nodiscard]] Instruction decode_long_multiplication(const Encoding& code);
/// Loads and stores of one register, of two bytes (A5.2.4) and of four (A5.3.7 to A5.3.10).
[[nodiscard]] Instruction decode_narrow_load_or_store(const Encoding& code);
[[nodiscard]] Instruction decode_single(const Encoding& code);
/// Of several registers: PUSH, POP, LDM, STM of two bytes, and of four (A5.3.5); of two, exclusive ones and branches by
/// a table (A5.3.6).
[[nodiscard]] Instruction decode_narrow_several(const Encoding& code);
[[nodiscard]] Instruction decode_several(const Encoding& code);
[[nodiscard]] Instruction decode_dual_or_exclusive(const Encoding& code);
/// Branches, IT, hints, special registers, SVC, BKPT (A5.2.5, A5.2.6, A5.3.4).
[[nodiscard]] Instruction decode_narrow_control(const Encoding& code);
[[nodiscard]] Instruction decode_control(const Encoding& code);

// A comparison and the conditional jump behind it are executed together: no other pair is as frequent.
/// The condition of a jump to an instruction beside it; nothing if it is none.
[[nodiscard]] std::optional<unsigned> condition_of_near_jump(Execute execute);
/// Executes a comparison and the jump behind it, which has this condition. Null if the first is none.
[[nodiscard]] Execute with_jump(Execute comparison, unsigned condition);

}  // namespace proleg::sim
