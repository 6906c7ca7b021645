// Branches, IT blocks, hints, special registers, and what ends a run.

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"
#include "sim/mcu/cpu/nvic.hpp"

namespace proleg::sim {
namespace {

// Branches. Instruction::immediate: the target; of a near one, its distance in halfwords.

template <bool is_near>
const Instruction* jump(Core& core, const Instruction& instruction) {
  if constexpr (is_near) {
    return core.go_on(near_target(instruction));
  } else {
    return core.go_on(core.branch(instruction.immediate));
  }
}

template <unsigned condition, bool is_near>
const Instruction* jump_if(Core& core, const Instruction& instruction) {
  return core.holds(condition) ? jump<is_near>(core, instruction) : core.go_on(after(instruction));
}

template <bool is_near>
const Instruction* call(Core& core, const Instruction& instruction) {
  core.r[link_register] = (instruction.address + 4) | 1U;
  return jump<is_near>(core, instruction);
}

/// CBZ, CBNZ.
template <bool if_zero, bool is_near>
const Instruction* jump_by_register(Core& core, const Instruction& instruction) {
  return (core.r[instruction.n] == 0) == if_zero ? jump<is_near>(core, instruction) : core.go_on(after(instruction));
}

const Instruction* jump_to_register(Core& core, const Instruction& instruction) {
  return core.go_on(core.branch_exchange(instruction, core.r[instruction.m]));
}

/// BLX, which does not return from exceptions.
const Instruction* call_register(Core& core, const Instruction& instruction) {
  const std::uint32_t target = core.r[instruction.m];
  core.r[link_register] = (instruction.address + 2) | 1U;
  return core.go_on(core.exchange(target));
}

/// By condition, without "always" (14).
template <bool is_near>
constexpr auto conditional_jumps = []<std::size_t... condition>(std::index_sequence<condition...>) {
  return std::array<Execute, sizeof...(condition)>{&jump_if<condition, is_near>...};
}
(std::make_index_sequence<14>());

/// Whether the target stands beside the branch. Behind an IT block it does not: the next instruction stands among those
/// outside.
bool set_target(Instruction& instruction, const Encoding& code, std::uint32_t target) {
  const bool is_near = !code.in_it_block && code.is_in_page() && target - code.page < CodePage::size;
  instruction.immediate =
      is_near ? static_cast<std::uint32_t>(static_cast<std::int32_t>(target - code.address) / 2) : target;
  return is_near;
}

std::uint32_t sign_extended(std::uint32_t value, unsigned width) {
  const std::uint32_t sign = 1U << (width - 1);
  return (value ^ sign) - sign;
}

Instruction branch(const Encoding& code, std::uint32_t distance) {
  Instruction instruction;
  instruction.execute = set_target(instruction, code, code.pc() + distance) ? &jump<true> : &jump<false>;
  return instruction;
}

Instruction conditional_branch(const Encoding& code, unsigned condition, std::uint32_t distance) {
  if (code.in_it_block || condition >= conditional_jumps<true>.size()) {
    return {};
  }
  Instruction instruction;
  const bool is_near = set_target(instruction, code, code.pc() + distance);
  instruction.execute = (is_near ? conditional_jumps<true> : conditional_jumps<false>).at(condition);
  return instruction;
}

/// Instruction::option: condition and mask.
template <bool is_in_page>
const Instruction* begin_it_block(Core& core, const Instruction& instruction) {
  core.it_state = instruction.option;
  if constexpr (is_in_page) {
    return core.go_on(after(instruction) + CodePage::slots);
  } else {
    return core.go_on(core.at(instruction.address + 2));
  }
}

const Instruction* wait_for_event(Core& core, const Instruction& instruction) {
  return core.finish(End::wait_for_event, after(instruction));
}

const Instruction* wait_for_interrupt(Core& core, const Instruction& instruction) {
  return core.finish(End::wait_for_interrupt, after(instruction));
}

const Instruction* send_event(Core& core, const Instruction& instruction) {
  core.client.send_event();
  return core.go_on(after(instruction));
}

Execute hint(unsigned number) {
  switch (number) {
    case 2:
      return &wait_for_event;
    case 3:
      return &wait_for_interrupt;
    case 4:
      return &send_event;
    default:
      return &do_nothing;
  }
}

const Instruction* call_supervisor(Core& core, const Instruction& instruction) {
  return core.finish(End::supervisor_call, after(instruction));
}

const Instruction* break_here(Core& core, const Instruction& instruction) {
  return core.finish(End::breakpoint_instruction, &instruction);
}

const Instruction* clear_exclusive(Core& core, const Instruction& instruction) {
  core.is_exclusive = false;
  return core.go_on(after(instruction));
}

// Special registers (DDI 0403, B5.1.1, B5.2.1 to B5.2.3).

/// FAULTMASK is not set by the handlers of NMI and HardFault.
void set_faultmask(Core& core, std::uint32_t value) {
  if (value == 0 || (core.exception != exception::nmi && core.exception != exception::hard_fault)) {
    core.faultmask = value;
  }
}

/// CPS: bits of the option: 0 FAULTMASK, 1 PRIMASK, 4 whether they are set.
const Instruction* change_masks(Core& core, const Instruction& instruction) {
  if (core.is_privileged()) {
    const std::uint32_t value = instruction.option >> 4U & 1U;
    if ((instruction.option & 2U) != 0) {
      core.primask = value;
    }
    if ((instruction.option & 1U) != 0) {
      set_faultmask(core, value);
    }
    core.attend();
  }
  return core.go_on(after(instruction));
}

/// Their numbers in MRS and MSR.
namespace special {
constexpr unsigned last_of_status = 7;
constexpr unsigned msp = 8;
constexpr unsigned psp = 9;
constexpr unsigned primask = 16;
constexpr unsigned basepri = 17;
constexpr unsigned basepri_max = 18;
constexpr unsigned faultmask = 19;
constexpr unsigned control = 20;
}  // namespace special

bool is_special_register(unsigned number) {
  return number <= special::psp ? number != 4 : number >= special::primask && number <= special::control;
}

/// MRS: the number is `immediate`. Unprivileged code reads 0 for all but the flags.
const Instruction* read_special(Core& core, const Instruction& instruction) {
  constexpr std::uint32_t flags = 0xF80F'0000;
  const unsigned number = instruction.immediate;
  std::uint32_t value = 0;
  if (number <= special::last_of_status) {
    const bool has_number = (number & 1U) != 0 && core.is_privileged();
    value = core.xpsr() & ((has_number ? exception_number_mask : 0U) | ((number & 4U) == 0 ? flags : 0U));
  } else if (number == special::control) {
    value = core.control;
  } else if (core.is_privileged()) {
    switch (number) {
      case special::msp:
      case special::psp:
        value = core.stack_pointer_of(number == special::psp);
        break;
      case special::primask:
        value = core.primask;
        break;
      case special::faultmask:
        value = core.faultmask;
        break;
      default:
        value = core.basepri;
        break;
    }
  }
  core.r[instruction.d] = value;
  return core.go_on(after(instruction));
}

/// MSR to a register that only privileged code changes.
void write_privileged(Core& core, unsigned number, std::uint32_t value) {
  constexpr std::uint32_t implemented_priority = Nvic::implemented_priority;
  switch (number) {
    case special::msp:
    case special::psp:
      core.set_stack_pointer_of(number == special::psp, value);
      break;
    case special::primask:
      core.primask = value & 1U;
      break;
    case special::basepri:
      core.basepri = value & implemented_priority;
      break;
    case special::basepri_max:
      if ((value & implemented_priority) != 0 && ((value & implemented_priority) < core.basepri || core.basepri == 0)) {
        core.basepri = value & implemented_priority;
      }
      break;
    case special::faultmask:
      set_faultmask(core, value & 1U);
      break;
    default:
      // SPSEL changes in thread mode only.
      core.control = core.exception == 0 ? value & 3U : (core.control & 2U) | (value & 1U);
      core.select_stack();
      break;
  }
  core.attend();
}

/// MSR: the number is `immediate`; bits of the option: 0 GE, 1 the other flags.
const Instruction* write_special(Core& core, const Instruction& instruction) {
  const unsigned number = instruction.immediate;
  const std::uint32_t value = core.r[instruction.n];
  if (number <= special::last_of_status) {
    if ((number & 4U) == 0) {
      if ((instruction.option & 2U) != 0) {
        core.set_flags(value);
      }
      if ((instruction.option & 1U) != 0) {
        core.set_greater_equal(value);
      }
    }
  } else if (core.is_privileged()) {
    write_privileged(core, number, value);
  }
  return core.go_on(after(instruction));
}

Instruction special_register(const Encoding& code) {
  Instruction instruction;
  instruction.immediate = code.more(0, 8);
  if (!is_special_register(instruction.immediate)) {
    return instruction;
  }
  if (code.bits(6) == 0) {
    instruction.n = code.reg(0, 4);
    instruction.option = static_cast<std::uint8_t>(code.more(10, 2));
    const bool is_valid = code.bits(4) == 0 && code.more(8, 2) == 0 && code.more(13) == 0 &&
                          instruction.n != stack_pointer && instruction.n != program_counter &&
                          instruction.option != 0 && (instruction.option == 2 || instruction.immediate < 4);
    instruction.execute = is_valid ? &write_special : nullptr;
    return instruction;
  }
  instruction.d = code.more_reg(8);
  const bool is_valid = code.bits(0, 5) == 0xF && code.more(13) == 0 && instruction.d != stack_pointer &&
                        instruction.d != program_counter;
  instruction.execute = is_valid ? &read_special : nullptr;
  return instruction;
}

Instruction hint_or_barrier(const Encoding& code) {
  Instruction instruction;
  if (code.bits(0, 4) != 0xF || code.more(13) != 0) {
    return instruction;
  }
  if (code.bits(4) == 0) {
    // The first bits of the number of DBG are 1.
    instruction.execute = code.more(8, 4) == 0 ? hint(code.more(0, 8)) : nullptr;
    return instruction;
  }
  const unsigned operation = code.more(4, 4);
  if (code.more(8, 4) == 0xF && operation == 2) {
    instruction.execute = &clear_exclusive;
  } else if (code.more(8, 4) == 0xF && operation >= 4 && operation <= 6) {  // DSB, DMB, ISB
    instruction.execute = &do_nothing;
  }
  return instruction;
}

/// B and BL with 24 bits: the sign changes two of them (A7.7.12, A7.7.18).
std::uint32_t long_distance(const Encoding& code) {
  const unsigned sign = code.bits(10);
  const unsigned first = (code.more(13) ^ sign) == 0 ? 1U : 0U;
  const unsigned second = (code.more(11) ^ sign) == 0 ? 1U : 0U;
  return sign_extended(sign << 24U | first << 23U | second << 22U | code.bits(0, 10) << 12U | code.more(0, 11) << 1U,
                       25);
}

Instruction it_or_hint(const Encoding& code) {
  const unsigned condition = code.bits(4, 4);
  const unsigned mask = code.bits(0, 4);
  Instruction instruction;
  if (mask == 0) {
    instruction.execute = hint(condition);
    return instruction;
  }
  const bool has_one = (mask & (mask - 1)) == 0;
  if (!code.in_it_block && condition != 15 && (condition != 14 || has_one)) {
    instruction.execute = code.is_in_page() ? &begin_it_block<true> : &begin_it_block<false>;
    instruction.option = static_cast<std::uint8_t>(code.bits(0, 8));
  }
  return instruction;
}

Instruction compare_and_branch(const Encoding& code) {
  Instruction instruction;
  instruction.n = code.reg(0);
  const std::uint32_t target = code.pc() + (code.bits(9) << 6U | code.bits(3, 5) << 1U);
  const bool is_near = set_target(instruction, code, target);
  if (code.in_it_block) {
    return {};
  }
  if (code.bits(11) == 0) {
    instruction.execute = is_near ? &jump_by_register<true, true> : &jump_by_register<true, false>;
  } else {
    instruction.execute = is_near ? &jump_by_register<false, true> : &jump_by_register<false, false>;
  }
  return instruction;
}

}  // namespace

std::optional<unsigned> condition_of_near_jump(Execute execute) {
  const auto found = std::ranges::find(conditional_jumps<true>, execute);
  return found != conditional_jumps<true>.end()
             ? std::optional(static_cast<unsigned>(found - conditional_jumps<true>.begin()))
             : std::nullopt;
}

Instruction decode_narrow_control(const Encoding& code) {
  Instruction instruction;
  if (code.first >> 8U == 0b01000111) {  // BX, BLX
    const bool calls = code.bits(7) != 0;
    instruction.m = code.reg(3, 4);
    if (code.bits(0, 3) == 0 && instruction.m != program_counter) {
      instruction.execute = calls ? &call_register : &jump_to_register;
    }
  } else if (code.first >> 12U == 0b1101) {
    const unsigned condition = code.bits(8, 4);
    if (condition == 15) {
      instruction.execute = &call_supervisor;
    } else {
      instruction = conditional_branch(code, condition, sign_extended(code.bits(0, 8) << 1U, 9));
    }
  } else if (code.first >> 11U == 0b11100) {
    instruction = branch(code, sign_extended(code.bits(0, 11) << 1U, 12));
  } else if ((code.first & 0xF500U) == 0xB100U) {
    instruction = compare_and_branch(code);
  } else if (code.first >> 8U == 0b10111110) {
    instruction.execute = &break_here;
  } else if (code.first >> 8U == 0b10111111) {
    instruction = it_or_hint(code);
  } else if (code.first >> 5U == 0b10110110011 && code.bits(2, 2) == 0 && code.bits(0, 2) != 0 && !code.in_it_block) {
    instruction.execute = &change_masks;
    instruction.option = static_cast<std::uint8_t>(code.bits(0, 5));
  }
  return instruction;
}

Instruction decode_control(const Encoding& code) {
  if (code.more(14) != 0) {  // BL
    if (code.more(12) == 0) {
      return {};
    }
    Instruction instruction;
    const bool is_near = set_target(instruction, code, code.pc() + long_distance(code));
    instruction.execute = is_near ? &call<true> : &call<false>;
    return instruction;
  }
  if (code.more(12) != 0) {
    return branch(code, long_distance(code));
  }
  const unsigned condition = code.bits(6, 4);
  if (condition < 14) {
    const std::uint32_t distance = code.bits(10) << 20U | code.more(11) << 19U | code.more(13) << 18U |
                                   code.bits(0, 6) << 12U | code.more(0, 11) << 1U;
    return conditional_branch(code, condition, sign_extended(distance, 21));
  }
  if (code.bits(10) != 0) {
    return {};
  }
  switch (code.bits(5, 2)) {
    case 0:
    case 3:
      return special_register(code);
    case 1:
      return hint_or_barrier(code);
    default:
      return {};
  }
}

}  // namespace proleg::sim
