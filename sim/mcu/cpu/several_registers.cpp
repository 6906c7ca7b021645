// Loads and stores of several registers and of two, exclusive ones, and branches by a table.

#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"
#include "sim/mcu/cpu/transfers.hpp"

namespace proleg::sim {
namespace {

using namespace transfer;

// Several registers: `immediate` is the list; `amount` their number.

/// Where the lowest register of the list is: at the base, or below it.
template <bool is_downwards>
std::uint32_t begin_of(const Core& core, const Instruction& instruction) {
  return core.r[instruction.n] - (is_downwards ? 4U * instruction.amount : 0U);
}

template <bool is_downwards>
std::uint32_t base_after(const Core& core, const Instruction& instruction) {
  const std::uint32_t size = 4U * instruction.amount;
  return is_downwards ? core.r[instruction.n] - size : core.r[instruction.n] + size;
}

/// Nothing of the registers changes before all words have been loaded, so that a fault leaves them as they were. bit 0
/// of the option: the base is written back.
template <bool is_downwards>
const Instruction* load_several(Core& core, const Instruction& instruction) {
  std::uint32_t address = begin_of<is_downwards>(core, instruction);
  if (!core.is_aligned(address, 4)) {
    return &instruction;
  }
  std::array<std::uint32_t, 16> values;
  unsigned count = 0;
  for (std::uint32_t list = instruction.immediate; list != 0; list &= list - 1) {
    if (!core.load<std::uint32_t>(address, values[count])) {
      return &instruction;
    }
    ++count;
    address += 4;
  }
  if ((instruction.option & 1U) != 0) {
    core.set(instruction.n, base_after<is_downwards>(core, instruction));
  }
  count = 0;
  for (std::uint32_t list = instruction.immediate & 0x7FFFU; list != 0; list &= list - 1) {
    core.r[static_cast<unsigned>(std::countr_zero(list))] = values[count++];
  }
  return core.go_on((instruction.immediate >> program_counter & 1U) != 0
                        ? core.branch_exchange(instruction, values[count])
                        : after(instruction));
}

template <bool is_downwards>
const Instruction* store_several(Core& core, const Instruction& instruction) {
  std::uint32_t address = begin_of<is_downwards>(core, instruction);
  if (!core.is_aligned(address, 4)) {
    return &instruction;
  }
  for (std::uint32_t list = instruction.immediate; list != 0; list &= list - 1) {
    if (!core.store<std::uint32_t>(address, core.r[static_cast<unsigned>(std::countr_zero(list))])) {
      return &instruction;
    }
    address += 4;
  }
  if ((instruction.option & 1U) != 0) {
    core.set(instruction.n, base_after<is_downwards>(core, instruction));
  }
  return core.go_on(after(instruction));
}

Instruction several(Execute execute, unsigned base, unsigned list, bool writes_back) {
  Instruction instruction;
  instruction.execute = execute;
  instruction.n = static_cast<std::uint8_t>(base);
  instruction.immediate = list;
  instruction.amount = static_cast<std::uint8_t>(std::popcount(list));
  instruction.option = writes_back ? 1 : 0;
  return instruction;
}

// Two registers, d and a.

template <Mode mode>
const Instruction* load_two(Core& core, const Instruction& instruction) {
  const std::uint32_t address = address_of<mode>(core, instruction);
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  if (!core.is_aligned(address, 4) || !core.load<std::uint32_t>(address, first) ||
      !core.load<std::uint32_t>(address + 4, second)) {
    return &instruction;
  }
  write_back<mode>(core, instruction);
  core.r[instruction.d] = first;
  core.r[instruction.a] = second;
  return core.go_on(after(instruction));
}

template <Mode mode>
const Instruction* store_two(Core& core, const Instruction& instruction) {
  const std::uint32_t address = address_of<mode>(core, instruction);
  if (!core.is_aligned(address, 4) || !core.store<std::uint32_t>(address, core.r[instruction.d]) ||
      !core.store<std::uint32_t>(address + 4, core.r[instruction.a])) {
    return &instruction;
  }
  write_back<mode>(core, instruction);
  return core.go_on(after(instruction));
}

constexpr auto loads_of_two = []<std::size_t... i>(std::index_sequence<i...>) {
  return std::array<Execute, sizeof...(i)>{&load_two<static_cast<Mode>(i)>...};
}
(modes);
constexpr auto stores_of_two = []<std::size_t... i>(std::index_sequence<i...>) {
  return std::array<Execute, sizeof...(i)>{&store_two<static_cast<Mode>(i)>...};
}
(modes);

template <Type type>
const Instruction* load_exclusive(Core& core, const Instruction& instruction) {
  const std::uint32_t address = core.r[instruction.n] + instruction.immediate;
  constexpr std::uint32_t size = type == Type::word ? 4 : type == Type::half ? 2 : 1;
  std::uint32_t value = 0;
  if (!core.is_aligned(address, size) || !load<type>(core, address, value)) {
    return &instruction;
  }
  core.is_exclusive = true;
  core.r[instruction.d] = value;
  return core.go_on(after(instruction));
}

/// a is the register that is stored, d that of the result.
template <Type type>
const Instruction* store_exclusive(Core& core, const Instruction& instruction) {
  const std::uint32_t address = core.r[instruction.n] + instruction.immediate;
  constexpr std::uint32_t size = type == Type::word ? 4 : type == Type::half ? 2 : 1;
  if (!core.is_aligned(address, size)) {
    return &instruction;
  }
  if (core.is_exclusive && !store<type>(core, address, core.r[instruction.a])) {
    return &instruction;
  }
  core.r[instruction.d] = core.is_exclusive ? 0 : 1;
  core.is_exclusive = false;
  return core.go_on(after(instruction));
}

/// TBB, TBH (amount is 1). The base is a register, or the PC.
template <Type type>
const Instruction* branch_by_table(Core& core, const Instruction& instruction) {
  const std::uint32_t base = instruction.n == program_counter ? instruction.address + 4 : core.r[instruction.n];
  std::uint32_t distance = 0;
  if (!load<type>(core, base + (core.r[instruction.m] << instruction.amount), distance)) {
    return &instruction;
  }
  return core.go_on(core.branch(instruction.address + 4 + 2 * distance));
}

Instruction exclusive_or_table(const Encoding& code) {
  const bool is_load = code.bits(4) != 0;
  Instruction instruction;
  instruction.n = code.reg(0, 4);
  if (code.bits(7) == 0) {  // words, with an offset
    instruction.immediate = 4 * code.more(0, 8);
    instruction.d = is_load ? code.more_reg(12) : code.more_reg(8);
    instruction.a = code.more_reg(12);
    const bool is_valid =
        instruction.n != program_counter && !is_sp_or_pc(instruction.d) && !is_sp_or_pc(instruction.a);
    if (is_load) {
      instruction.execute = is_valid && code.more(8, 4) == 0xF ? &load_exclusive<Type::word> : nullptr;
    } else {
      instruction.execute = is_valid && instruction.d != instruction.n && instruction.d != instruction.a
                                ? &store_exclusive<Type::word>
                                : nullptr;
    }
    return instruction;
  }
  const unsigned operation = code.more(4, 4);
  if (is_load && operation < 2) {
    instruction.m = code.more_reg(0);
    instruction.amount = static_cast<std::uint8_t>(operation);
    if (instruction.n != stack_pointer && !is_sp_or_pc(instruction.m) && code.more(8, 8) == 0xF0) {
      instruction.execute = operation == 0 ? &branch_by_table<Type::byte> : &branch_by_table<Type::half>;
    }
    return instruction;
  }
  instruction.d = is_load ? code.more_reg(12) : code.more_reg(0);
  instruction.a = code.more_reg(12);
  const bool has_other_bits = code.more(8, 4) == 0xF && (!is_load || code.more(0, 4) == 0xF);
  const bool is_valid = has_other_bits && instruction.n != program_counter && !is_sp_or_pc(instruction.d) &&
                        !is_sp_or_pc(instruction.a) &&
                        (is_load || (instruction.d != instruction.n && instruction.d != instruction.a));
  if (is_valid && operation == 4) {
    instruction.execute = is_load ? &load_exclusive<Type::byte> : &store_exclusive<Type::byte>;
  } else if (is_valid && operation == 5) {
    instruction.execute = is_load ? &load_exclusive<Type::half> : &store_exclusive<Type::half>;
  }
  return instruction;
}

}  // namespace

Instruction decode_narrow_several(const Encoding& code) {
  const unsigned group = code.first >> 11U;
  if (code.first >> 9U == 0b1011010) {  // PUSH
    const unsigned list = code.bits(0, 8) | code.bits(8) << link_register;
    return list != 0 ? several(&store_several<true>, stack_pointer, list, true) : Instruction{};
  }
  if (code.first >> 9U == 0b1011110) {  // POP
    const unsigned list = code.bits(0, 8) | code.bits(8) << program_counter;
    return list != 0 ? several(&load_several<false>, stack_pointer, list, true) : Instruction{};
  }
  const unsigned base = code.bits(8, 3);
  const unsigned list = code.bits(0, 8);
  const bool has_base = (list >> base & 1U) != 0;
  if (group == 0b11000 && list != 0 && (!has_base || (list & ((1U << base) - 1U)) == 0)) {
    return several(&store_several<false>, base, list, true);
  }
  if (group == 0b11001 && list != 0) {
    return several(&load_several<false>, base, list, !has_base);
  }
  return {};
}

Instruction decode_several(const Encoding& code) {
  const unsigned base = code.bits(0, 4);
  const unsigned list = code.second;
  const bool is_load = code.bits(4) != 0;
  const bool writes_back = code.bits(5) != 0;
  const bool has_base = (list >> base & 1U) != 0;
  const bool has_pc = (list >> program_counter & 1U) != 0;
  const bool has_lr = (list >> link_register & 1U) != 0;
  const bool is_valid = base != program_counter && std::popcount(list) >= 2 && (list >> stack_pointer & 1U) == 0 &&
                        !(writes_back && has_base) && (is_load ? !(has_pc && has_lr) : !has_pc);
  const unsigned direction = code.bits(7, 2);
  if (!is_valid || direction == 0 || direction == 3) {
    return {};
  }
  if (direction == 1) {
    return several(is_load ? &load_several<false> : &store_several<false>, base, list, writes_back);
  }
  return several(is_load ? &load_several<true> : &store_several<true>, base, list, writes_back);
}

Instruction decode_dual_or_exclusive(const Encoding& code) {
  const bool is_before = code.bits(8) != 0;
  const bool is_kept = code.bits(5) != 0;
  if (!is_before && !is_kept) {
    return exclusive_or_table(code);
  }
  const bool is_load = code.bits(4) != 0;
  const bool adds = code.bits(7) != 0;
  Instruction instruction;
  instruction.n = code.reg(0, 4);
  instruction.d = code.more_reg(12);
  instruction.a = code.more_reg(8);
  const std::uint32_t offset = 4 * code.more(0, 8);
  instruction.immediate = adds ? offset : 0U - offset;
  Mode mode = is_before ? (is_kept ? Mode::pre_indexed : Mode::offset) : Mode::post_indexed;
  if (instruction.n == program_counter) {
    if (!is_load || is_kept) {
      return {};
    }
    instruction.immediate += code.pc() & ~3U;
    mode = Mode::absolute;
  }
  const bool has_base = instruction.n == instruction.d || instruction.n == instruction.a;
  if (is_sp_or_pc(instruction.d) || is_sp_or_pc(instruction.a) || (is_kept && has_base) ||
      (is_load && instruction.d == instruction.a)) {
    return {};
  }
  instruction.execute = (is_load ? loads_of_two : stores_of_two).at(static_cast<std::size_t>(mode));
  return instruction;
}

}  // namespace proleg::sim
