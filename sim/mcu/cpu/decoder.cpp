#include "sim/mcu/cpu/decoder.hpp"

#include <optional>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::sim {
namespace {

const Instruction* refuse(Core& core, const Instruction& instruction) {
  return core.finish(End::undefined_instruction, &instruction);
}

const Instruction* refuse_coprocessor(Core& core, const Instruction& instruction) {
  return core.finish(core.client.coprocessor_allowed() ? End::floating_point : End::no_coprocessor, &instruction);
}

const Instruction* refuse_state(Core& core, const Instruction& instruction) {
  return core.finish(End::invalid_state, &instruction);
}

const Instruction* fail_fetch(Core& core, const Instruction& instruction) {
  core.fault = {instruction.address, 2, false, true};
  return core.finish(End::memory_fault, &instruction);
}

const Instruction* continue_behind(Core& core, const Instruction& instruction) {
  const Instruction* const next = core.at(instruction.address);
  core.present = next;
  return next->execute(core, *next);
}

/// An instruction of an IT block (DDI 0403, A7.3.3).
template <bool is_in_page>
const Instruction* execute_if(Core& core, const Instruction& instruction) {
  const unsigned state = core.it_state;
  const auto rest = static_cast<std::uint8_t>((state & 7U) == 0 ? 0U : (state & 0xE0U) | (state << 1U & 0x1FU));
  const Instruction* const behind = after(instruction);
  core.it_state = rest;
  if (core.holds_now(state >> 4U)) {
    // It must not go on by itself: if the block ends here, what follows stands elsewhere.
    const std::uint32_t left = core.left;
    core.set_left(0);
    const Instruction* const next = instruction.conditional(core, instruction);
    if (core.end >= End::breakpoint_instruction) {  // it was not executed
      core.it_state = static_cast<std::uint8_t>(state);
      return next;
    }
    core.give_back(left);
    if (next != behind) {
      return core.go_on(next);
    }
  }
  if (rest != 0) {
    return core.go_on(behind);
  }
  return core.go_on(is_in_page ? behind - CodePage::slots : core.at(instruction.address + 2U * instruction.halfwords));
}

Instruction decode_narrow(const Encoding& code) {
  constexpr Instruction (*groups[])(const Encoding&){
      &decode_narrow_data_processing, &decode_narrow_multiplication, &decode_narrow_register_processing,
      &decode_narrow_load_or_store,   &decode_narrow_several,        &decode_narrow_control};
  for (const auto group : groups) {
    if (const Instruction instruction = group(code); instruction.execute != nullptr) {
      return instruction;
    }
  }
  return {};
}

/// A5.3.
Instruction decode_wide(const Encoding& code) {
  if (is_coprocessor_instruction(code.first)) {
    Instruction instruction;
    instruction.execute = &refuse_coprocessor;
    return instruction;
  }
  const unsigned operation = code.bits(4, 7);
  switch (code.bits(11, 2)) {
    case 1:
      if ((operation & 0x64U) == 0) {
        return decode_several(code);
      }
      return (operation & 0x64U) == 4 ? decode_dual_or_exclusive(code) : decode_shifted_register(code);
    case 2:
      if (code.more(15) != 0) {
        return decode_control(code);
      }
      return (operation & 0x20U) == 0 ? decode_modified_constant(code) : decode_plain_constant(code);
    default:
      if ((operation & 0x60U) == 0) {
        return decode_single(code);
      }
      if ((operation & 0x70U) == 0x20U) {
        return decode_register_processing(code);
      }
      return (operation & 0x78U) == 0x30U ? decode_multiplication(code) : decode_long_multiplication(code);
  }
}

Instruction standing_in(Execute execute, std::uint32_t address) {
  Instruction instruction;
  instruction.execute = execute;
  instruction.address = address;
  return instruction;
}

Instruction decode(const Encoding& code) {
  const bool is_wide = instruction_size(code.first) == 4;
  Instruction instruction = is_wide ? decode_wide(code) : decode_narrow(code);
  instruction.address = code.address;
  instruction.halfwords = is_wide ? 2 : 1;
  if (instruction.execute == nullptr) {
    instruction.execute = &refuse;
  }
  constexpr unsigned bkpt = 0b10111110;  // executed whether or not its condition holds
  if (code.in_it_block && code.first >> 8U != bkpt) {
    instruction.conditional = instruction.execute;
    instruction.execute = code.is_in_page() ? &execute_if<true> : &execute_if<false>;
  }
  return instruction;
}

Execute joined(const Instruction& first, const Instruction& second) {
  const std::optional<unsigned> condition = condition_of_near_jump(second.execute);
  return condition ? with_jump(first.execute, *condition) : nullptr;
}

Instruction continuation(std::uint32_t address) { return standing_in(&continue_behind, address); }
Instruction fetch_fault(std::uint32_t address) { return standing_in(&fail_fetch, address); }
Instruction invalid_state(std::uint32_t address) { return standing_in(&refuse_state, address); }

}  // namespace

const InstructionSet thumb_instructions{&decode, &joined, &continuation, &fetch_fault, &invalid_state};

const Instruction* do_nothing(Core& core, const Instruction& instruction) { return core.go_on(after(instruction)); }

}  // namespace proleg::sim
