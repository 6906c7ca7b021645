// Loads and stores of one register.

#include <array>
#include <cstddef>
#include <utility>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"
#include "sim/mcu/cpu/thumb.hpp"
#include "sim/mcu/cpu/transfers.hpp"

namespace proleg::sim {
namespace {

using namespace transfer;

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

/// Loads a word at a constant address, `immediate`: the word is taken now if the page depends on it.
void set_literal(Instruction& instruction, const Encoding& code) {
  const std::uint32_t offset = instruction.immediate - code.page;
  const bool is_in_flash = instruction.immediate - ChipMemory::flash_start <= ChipMemory::flash_size - 4;
  if (code.is_in_page() && is_in_flash && offset % 4 == 0 && offset <= code.memory.size() - 4) {
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

/// The functions by type and mode; those that load the PC by mode.
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
  const bool is_one =
      group == 0b01001 || code.first >> 12U == 0b0101 || code.first >> 13U == 0b011 || code.first >> 13U == 0b100;
  return is_one ? narrow_one(code) : Instruction{};
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
