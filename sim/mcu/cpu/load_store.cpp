// Loads and stores of one register, of two, of several, and exclusive ones.

#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"
#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::sim {
namespace {

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

template <Type type, Mode mode>
const Instruction* load_one(Core& core, const Instruction& instruction) {
  std::uint32_t value = 0;
  if (!load<type>(core, address_of<mode>(core, instruction), value)) {
    return &instruction;
  }
  write_back<mode>(core, instruction);
  core.set(instruction.d, value);
  return core.go_on(after(instruction));
}

const Instruction* load_constant(Core& core, const Instruction& instruction) {
  core.set(instruction.d, instruction.immediate);
  return core.go_on(after(instruction));
}

/// Loads a word at a constant address, `immediate`: the word is taken now if it belongs to the page.
void set_literal(Instruction& instruction, const Encoding& code) {
  const std::uint32_t offset = instruction.immediate - code.page;
  if (code.is_in_page() && offset % 4 == 0 && offset <= code.memory.size() - 4) {
    instruction.execute = &load_constant;
    instruction.immediate = halfword_at(code.memory, offset) | std::uint32_t{halfword_at(code.memory, offset + 2)}
                                                                   << 16U;
  } else {
    instruction.execute = &load_one<Type::word, Mode::absolute>;
  }
}

template <Mode mode>
const Instruction* load_pc(Core& core, const Instruction& instruction) {
  std::uint32_t value = 0;
  const std::uint32_t address = address_of<mode>(core, instruction);
  if (!core.is_aligned(address, 4) || !core.load<std::uint32_t>(address, value)) {
    return &instruction;
  }
  write_back<mode>(core, instruction);
  return core.go_on(core.branch_exchange(instruction, value));
}

template <Type type, Mode mode>
const Instruction* store_one(Core& core, const Instruction& instruction) {
  if (!store<type>(core, address_of<mode>(core, instruction), core.r[instruction.d])) {
    return &instruction;
  }
  write_back<mode>(core, instruction);
  return core.go_on(after(instruction));
}

/// The functions by mode; of one register by type, too.
constexpr std::size_t mode_count = 5;
constexpr std::size_t type_count = 5;
constexpr auto modes = std::make_index_sequence<mode_count>();
constexpr auto types_and_modes = std::make_index_sequence<type_count * mode_count>();

constexpr auto loads_of_one = []<std::size_t... i>(std::index_sequence<i...>) {
  return std::array<Execute, sizeof...(i)>{
      &load_one<static_cast<Type>(i / mode_count), static_cast<Mode>(i % mode_count)>...};
}
(types_and_modes);
constexpr auto stores_of_one = []<std::size_t... i>(std::index_sequence<i...>) {
  return std::array<Execute, sizeof...(i)>{
      &store_one<static_cast<Type>(i / mode_count), static_cast<Mode>(i % mode_count)>...};
}
(types_and_modes);
constexpr auto loads_of_pc = []<std::size_t... i>(std::index_sequence<i...>) {
  return std::array<Execute, sizeof...(i)>{&load_pc<static_cast<Mode>(i)>...};
}
(modes);

Execute loading(Type type, Mode mode) {
  return loads_of_one.at(static_cast<std::size_t>(type) * mode_count + static_cast<std::size_t>(mode));
}

Execute storing(Type type, Mode mode) {
  return stores_of_one.at(static_cast<std::size_t>(type) * mode_count + static_cast<std::size_t>(mode));
}

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

struct OneRegister {
  Type type;
  bool is_load;
};

/// A5.2.4: one register.
Instruction narrow_one(const Encoding& code) {
  constexpr OneRegister by_register[8]{{Type::word, false},       {Type::half, false},      {Type::byte, false},
                                       {Type::signed_byte, true}, {Type::word, true},       {Type::half, true},
                                       {Type::byte, true},        {Type::signed_half, true}};
  Instruction instruction;
  instruction.d = code.reg(0);
  instruction.n = code.reg(3);
  const bool is_load = code.bits(11) != 0;
  const auto with = [&](Type type, Mode mode, bool loads) {
    instruction.execute = loads ? loading(type, mode) : storing(type, mode);
    return instruction;
  };
  switch (code.first >> 12U) {
    case 0b0100:  // of a literal
      instruction.d = code.reg(8);
      instruction.immediate = (code.pc() & ~3U) + 4 * code.bits(0, 8);
      set_literal(instruction, code);
      return instruction;
    case 0b0101:
      instruction.m = code.reg(6);
      return with(by_register[code.bits(9, 3)].type, Mode::indexed, by_register[code.bits(9, 3)].is_load);
    case 0b0110:
      instruction.immediate = 4 * code.bits(6, 5);
      return with(Type::word, Mode::offset, is_load);
    case 0b0111:
      instruction.immediate = code.bits(6, 5);
      return with(Type::byte, Mode::offset, is_load);
    case 0b1000:
      instruction.immediate = 2 * code.bits(6, 5);
      return with(Type::half, Mode::offset, is_load);
    default:
      instruction.d = code.reg(8);
      instruction.n = stack_pointer;
      instruction.immediate = 4 * code.bits(0, 8);
      return with(Type::word, Mode::offset, is_load);
  }
}

/// Type of one register by the size in the first halfword.
Type type_of(unsigned size, bool is_signed) {
  if (size == 2) {
    return Type::word;
  }
  if (size == 1) {
    return is_signed ? Type::signed_half : Type::half;
  }
  return is_signed ? Type::signed_byte : Type::byte;
}

/// How the second halfword gives the address; sets its operands. Nothing is valid if the last result is false.
bool set_address(Instruction& instruction, const Encoding& code, Mode& mode) {
  if (instruction.n == program_counter) {
    const std::uint32_t base = code.pc() & ~3U;
    instruction.immediate = code.bits(7) != 0 ? base + code.more(0, 12) : base - code.more(0, 12);
    mode = Mode::absolute;
    return true;
  }
  if (code.bits(7) != 0) {
    instruction.immediate = code.more(0, 12);
    mode = Mode::offset;
    return true;
  }
  if (code.more(11) == 0) {
    instruction.m = code.more_reg(0);
    instruction.amount = static_cast<std::uint8_t>(code.more(4, 2));
    mode = Mode::indexed;
    return code.more(6, 5) == 0 && !is_sp_or_pc(instruction.m);
  }
  const bool is_before = code.more(10) != 0;
  const bool adds = code.more(9) != 0;
  const bool is_kept = code.more(8) != 0;
  instruction.immediate = adds ? code.more(0, 8) : 0U - code.more(0, 8);
  if (is_before) {
    mode = is_kept ? Mode::pre_indexed : Mode::offset;
    // LDRT, STRT and the like differ with an MPU only.
    const bool is_unprivileged = adds && !is_kept;
    return !is_unprivileged || !is_sp_or_pc(instruction.d);
  }
  mode = Mode::post_indexed;
  return is_kept;
}

}  // namespace

Instruction decode_narrow_load_or_store(const Encoding& code) {
  const unsigned group = code.first >> 11U;
  if (group == 0b01001 || code.first >> 12U == 0b0101 || code.first >> 13U == 0b011 || code.first >> 13U == 0b100) {
    return narrow_one(code);
  }
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

Instruction decode_single(const Encoding& code) {
  Instruction instruction;
  instruction.n = code.reg(0, 4);
  instruction.d = code.more_reg(12);
  const bool is_load = code.bits(4) != 0;
  const bool is_signed = code.bits(8) != 0;
  const unsigned size = code.bits(5, 2);
  if (size == 3 || (is_signed && (size == 2 || !is_load)) || (!is_load && instruction.n == program_counter)) {
    return {};
  }
  Mode mode = Mode::offset;
  if (!set_address(instruction, code, mode)) {
    return {};
  }
  const bool is_kept = mode == Mode::pre_indexed || mode == Mode::post_indexed;
  const Type type = type_of(size, is_signed);
  if (is_kept && instruction.n == instruction.d) {
    return {};
  }
  if (instruction.d == program_counter) {
    if (!is_load || (is_kept && size != 2)) {
      return {};
    }
    // PLD, PLI, and those that are reserved for hints, for smaller sizes.
    instruction.execute = size == 2 ? loads_of_pc.at(static_cast<std::size_t>(mode)) : &do_nothing;
    return instruction;
  }
  if (instruction.d == stack_pointer && type != Type::word) {
    return {};
  }
  if (is_load && type == Type::word && mode == Mode::absolute) {
    set_literal(instruction, code);
  } else {
    instruction.execute = is_load ? loading(type, mode) : storing(type, mode);
  }
  return instruction;
}

}  // namespace proleg::sim
