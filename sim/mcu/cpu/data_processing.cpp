// Sums, comparisons, logic and shifts.

#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"
#include "sim/mcu/cpu/shifts.hpp"

namespace proleg::sim {
namespace {

enum class Operation : std::uint8_t { conjunction, bic, orr, orn, eor, add, adc, sbc, sub, rsb, mov, mvn };
/// constant: Instruction::immediate, whose option is the carry of its expansion; plain: a register; shifted: by a
/// constant.
enum class Operand : std::uint8_t { constant, plain, shifted };
/// Where the result goes.
enum class Result : std::uint8_t { written, written_with_flags, only_flags };

/// Instruction::option of a constant: what the expansion does to the carry flag.
enum CarryOfConstant : std::uint8_t { keeps_carry, clears_carry, sets_carry };

struct Sum {
  std::uint32_t value;
  std::uint32_t carry;
  std::uint32_t overflow;  ///< bit 31
};

Sum sum_of(std::uint32_t a, std::uint32_t b, std::uint32_t carry) {
  const std::uint64_t wide = std::uint64_t{a} + b + carry;
  const auto value = static_cast<std::uint32_t>(wide);
  return {value, static_cast<std::uint32_t>(wide >> 32U), (a ^ value) & (b ^ value)};
}

template <Operand kind>
Shifted operand_of(const Core& core, const Instruction& instruction) {
  if constexpr (kind == Operand::constant) {
    return {instruction.immediate, instruction.option == keeps_carry ? core.carry : instruction.option - 1U};
  } else if constexpr (kind == Operand::plain) {
    return {core.r[instruction.m], core.carry};
  } else {
    return shifted(core.r[instruction.m], instruction.shift, instruction.amount, core.carry);
  }
}

template <Operation operation>
constexpr bool is_sum = operation == Operation::add || operation == Operation::adc || operation == Operation::sbc ||
                        operation == Operation::sub || operation == Operation::rsb;

template <Operation operation>
std::uint32_t logic_of(std::uint32_t a, std::uint32_t b) {
  switch (operation) {
    case Operation::conjunction:
      return a & b;
    case Operation::bic:
      return a & ~b;
    case Operation::orr:
      return a | b;
    case Operation::orn:
      return a | ~b;
    case Operation::eor:
      return a ^ b;
    case Operation::mvn:
      return ~b;
    default:
      return b;
  }
}

template <Operation operation>
Sum sum_for(std::uint32_t a, std::uint32_t b, std::uint32_t carry) {
  switch (operation) {
    case Operation::add:
      return sum_of(a, b, 0);
    case Operation::adc:
      return sum_of(a, b, carry);
    case Operation::sbc:
      return sum_of(a, ~b, carry);
    case Operation::sub:
      return sum_of(a, ~b, 1);
    default:
      return sum_of(b, ~a, 1);
  }
}

template <Operation operation, Operand kind, Result result>
void compute_only(Core& core, const Instruction& instruction) {
  const Shifted b = operand_of<kind>(core, instruction);
  std::uint32_t value = 0;
  if constexpr (is_sum<operation>) {
    const Sum sum = sum_for<operation>(core.r[instruction.n], b.value, core.carry);
    value = sum.value;
    if constexpr (result != Result::written) {
      core.carry = sum.carry;
      core.overflow = sum.overflow;
    }
  } else {
    value = logic_of<operation>(core.r[instruction.n], b.value);
    if constexpr (result != Result::written) {
      core.carry = b.carry;
    }
  }
  if constexpr (result != Result::written) {
    core.set_negative_and_zero(value);
  }
  if constexpr (result != Result::only_flags) {
    core.set(instruction.d, value);
  }
}

template <Operation operation, Operand kind, Result result>
const Instruction* compute(Core& core, const Instruction& instruction) {
  compute_only<operation, kind, result>(core, instruction);
  return core.go_on(after(instruction));
}

/// Computes, and executes the jump behind, whose target stands beside it.
template <Operation operation, Operand kind, Result result, unsigned condition>
const Instruction* compute_and_jump(Core& core, const Instruction& instruction) {
  compute_only<operation, kind, result>(core, instruction);
  const Instruction* const jump = after(instruction);
  if (!core.begin_next(jump)) {
    return jump;
  }
  return core.go_on(core.holds(condition) ? near_target(*jump) : after(*jump));
}

/// Each operation with each operand and result, in the order of their numbers.
constexpr std::size_t operand_count = 3;
constexpr std::size_t result_count = 3;
constexpr std::size_t operation_count = 12;
constexpr auto executions = []<std::size_t... i>(std::index_sequence<i...>) {
  return std::array<Execute, sizeof...(i)>{
      &compute<static_cast<Operation>(i / (operand_count * result_count)),
               static_cast<Operand>(i / result_count % operand_count), static_cast<Result>(i % result_count)>...};
}
(std::make_index_sequence<operation_count * operand_count * result_count>());

Execute execution(Operation operation, Operand kind, Result result) {
  const std::size_t number =
      (static_cast<std::size_t>(operation) * operand_count + static_cast<std::size_t>(kind)) * result_count;
  return executions.at(number + static_cast<std::size_t>(result));
}

/// By condition, without "always" (14).
template <Operation operation, Operand kind, Result result>
constexpr auto computations_with_jump = []<std::size_t... condition>(std::index_sequence<condition...>) {
  return std::array<Execute, sizeof...(condition)>{&compute_and_jump<operation, kind, result, condition>...};
}
(std::make_index_sequence<14>());

/// ADD and MOV to PC.
template <bool adds>
const Instruction* branch_by_sum(Core& core, const Instruction& instruction) {
  const std::uint32_t base = adds ? instruction.address + 4 : 0U;
  return core.go_on(core.branch((base + core.r[instruction.m]) & ~1U));
}

/// MOV of PC to itself.
const Instruction* branch_to_constant(Core& core, const Instruction& instruction) {
  return core.go_on(core.branch(instruction.immediate));
}

Result narrow_result(const Encoding& code) { return code.in_it_block ? Result::written : Result::written_with_flags; }

Instruction constant_operation(Operation operation, Result result, std::uint8_t d, std::uint8_t n,
                               std::uint32_t constant) {
  Instruction instruction;
  instruction.execute = execution(operation, Operand::constant, result);
  instruction.d = d;
  instruction.n = n;
  instruction.immediate = constant;
  return instruction;
}

Instruction register_operation(Operation operation, Result result, std::uint8_t d, std::uint8_t n, std::uint8_t m) {
  Instruction instruction;
  instruction.execute = execution(operation, Operand::plain, result);
  instruction.d = d;
  instruction.n = n;
  instruction.m = m;
  return instruction;
}

/// A5.2.1: bits 15 and 14 are 0.
Instruction narrow_shift_or_sum(const Encoding& code) {
  const Result result = narrow_result(code);
  const std::uint8_t low = code.reg(0);
  const std::uint8_t middle = code.reg(3);
  const std::uint8_t high = code.reg(8);
  switch (code.bits(11, 3)) {
    case 0:
    case 1:
    case 2: {
      Instruction instruction = register_operation(Operation::mov, result, low, 0, middle);
      set_constant_shift(instruction, code.bits(11, 2), code.bits(6, 5));
      if (instruction.amount != 0) {
        instruction.execute = execution(Operation::mov, Operand::shifted, result);
      }
      return instruction;
    }
    case 3: {
      const Operation operation = code.bits(9) == 0 ? Operation::add : Operation::sub;
      return code.bits(10) == 0 ? register_operation(operation, result, low, middle, code.reg(6))
                                : constant_operation(operation, result, low, middle, code.bits(6, 3));
    }
    case 4:
      return constant_operation(Operation::mov, result, high, 0, code.bits(0, 8));
    case 5:
      return constant_operation(Operation::sub, Result::only_flags, 0, high, code.bits(0, 8));
    case 6:
      return constant_operation(Operation::add, result, high, high, code.bits(0, 8));
    default:
      return constant_operation(Operation::sub, result, high, high, code.bits(0, 8));
  }
}

/// A5.2.2, but for MUL and the shifts.
Instruction narrow_registers(const Encoding& code) {
  using enum Operation;
  const Result result = narrow_result(code);
  const std::uint8_t d = code.reg(0);
  const std::uint8_t m = code.reg(3);
  const auto with = [&](Operation operation) { return register_operation(operation, result, d, d, m); };
  const auto comparison = [&](Operation operation) {
    return register_operation(operation, Result::only_flags, 0, d, m);
  };
  switch (code.bits(6, 4)) {
    case 0:
      return with(conjunction);
    case 1:
      return with(eor);
    case 5:
      return with(adc);
    case 6:
      return with(sbc);
    case 8:
      return comparison(conjunction);
    case 9:
      return constant_operation(rsb, result, d, m, 0);
    case 10:
      return comparison(sub);
    case 11:
      return comparison(add);
    case 12:
      return with(orr);
    case 14:
      return with(bic);
    case 15:
      return with(mvn);
    default:
      return {};
  }
}

/// A5.2.3, but for BX and BLX: ADD, CMP and MOV of any registers.
Instruction narrow_high_registers(const Encoding& code) {
  const auto d = static_cast<std::uint8_t>(code.bits(0, 3) | code.bits(7) << 3U);
  const std::uint8_t m = code.reg(3, 4);
  switch (code.bits(8, 2)) {
    case 0:
      if (d == program_counter) {
        Instruction instruction;
        instruction.execute = m == program_counter ? nullptr : &branch_by_sum<true>;
        instruction.m = m;
        return instruction;
      }
      return m == program_counter ? constant_operation(Operation::add, Result::written, d, d, code.pc())
                                  : register_operation(Operation::add, Result::written, d, d, m);
    case 1:
      if ((d < 8 && m < 8) || d == program_counter || m == program_counter) {
        return {};
      }
      return register_operation(Operation::sub, Result::only_flags, 0, d, m);
    case 2:
      if (d == program_counter) {
        Instruction instruction;
        instruction.execute = m == program_counter ? &branch_to_constant : &branch_by_sum<false>;
        instruction.m = m;
        instruction.immediate = code.pc();
        return instruction;
      }
      return m == program_counter ? constant_operation(Operation::mov, Result::written, d, 0, code.pc())
                                  : register_operation(Operation::mov, Result::written, d, 0, m);
    default:
      return {};
  }
}

struct Named {
  Operation operation;
  Result result;
  bool is_known;
};

/// The operation of the four bits that A5.3.1 and A5.3.11 have in common, with the registers that stand for others.
Named operation_of(unsigned code, unsigned n, unsigned d, bool sets_flags) {
  using enum Operation;
  const Result written = sets_flags ? Result::written_with_flags : Result::written;
  const bool compares = sets_flags && d == program_counter;
  const Result or_only_flags = compares ? Result::only_flags : written;
  switch (code) {
    case 0:
      return {conjunction, or_only_flags, true};
    case 1:
      return {bic, written, true};
    case 2:
      return {n == program_counter ? mov : orr, written, true};
    case 3:
      return {n == program_counter ? mvn : orn, written, true};
    case 4:
      return {eor, or_only_flags, true};
    case 8:
      return {add, or_only_flags, true};
    case 10:
      return {adc, written, true};
    case 11:
      return {sbc, written, true};
    case 13:
      return {sub, or_only_flags, true};
    case 14:
      return {rsb, written, true};
    default:
      return {mov, written, false};
  }
}

/// Whether an operation of four bytes may have these registers; but for the moves of a register.
bool may_use(const Named& named, unsigned d, unsigned n) {
  const bool is_move = named.operation == Operation::mov || named.operation == Operation::mvn;
  const bool may_be_of_sp = named.operation == Operation::add || named.operation == Operation::sub;
  if (!is_move && (n == program_counter || (n == stack_pointer && !may_be_of_sp))) {
    return false;
  }
  return named.result == Result::only_flags ||
         (d != program_counter && (d != stack_pointer || (may_be_of_sp && n == stack_pointer)));
}

// A5.3.2.
struct Expanded {
  std::uint32_t value;
  CarryOfConstant carry;
  bool is_valid;
};

Expanded expanded(const Encoding& code) {
  const unsigned constant = code.bits(10) << 11U | code.more(12, 3) << 8U | code.more(0, 8);
  const std::uint32_t byte = constant & 0xFFU;
  if (constant >> 10U == 0) {
    const std::array<std::uint32_t, 4> patterns{byte, byte << 16U | byte, byte << 24U | byte << 8U,
                                                byte << 24U | byte << 16U | byte << 8U | byte};
    const unsigned pattern = constant >> 8U;
    return {patterns.at(pattern), keeps_carry, pattern == 0 || byte != 0};
  }
  const std::uint32_t value = std::rotr((constant & 0x7FU) | 0x80U, static_cast<int>(constant >> 7U));
  return {value, value >> 31U != 0 ? sets_carry : clears_carry, true};
}

/// MOVT.
const Instruction* move_top(Core& core, const Instruction& instruction) {
  core.r[instruction.d] = (core.r[instruction.d] & 0xFFFFU) | instruction.immediate << 16U;
  return core.go_on(after(instruction));
}

}  // namespace

Execute with_jump(Execute comparison, unsigned condition) {
  using enum Operand;
  using enum Result;
  if (comparison == &compute<Operation::sub, constant, only_flags>) {  // CMP
    return computations_with_jump<Operation::sub, constant, only_flags>.at(condition);
  }
  if (comparison == &compute<Operation::sub, plain, only_flags>) {
    return computations_with_jump<Operation::sub, plain, only_flags>.at(condition);
  }
  if (comparison == &compute<Operation::sub, constant, written_with_flags>) {  // SUBS
    return computations_with_jump<Operation::sub, constant, written_with_flags>.at(condition);
  }
  if (comparison == &compute<Operation::conjunction, constant, only_flags>) {  // TST
    return computations_with_jump<Operation::conjunction, constant, only_flags>.at(condition);
  }
  return nullptr;
}

Instruction decode_narrow_data_processing(const Encoding& code) {
  const unsigned group = code.first >> 10U;
  if (group < 0b010000) {
    return narrow_shift_or_sum(code);
  }
  if (group == 0b010000) {
    return narrow_registers(code);
  }
  if (group == 0b010001) {
    return narrow_high_registers(code);
  }
  if (code.first >> 11U == 0b10100) {  // ADR
    return constant_operation(Operation::mov, Result::written, code.reg(8), 0, (code.pc() & ~3U) + 4 * code.bits(0, 8));
  }
  if (code.first >> 11U == 0b10101) {
    return constant_operation(Operation::add, Result::written, code.reg(8), stack_pointer, 4 * code.bits(0, 8));
  }
  if (code.first >> 8U == 0b10110000) {
    return constant_operation(code.bits(7) == 0 ? Operation::add : Operation::sub, Result::written, stack_pointer,
                              stack_pointer, 4 * code.bits(0, 7));
  }
  return {};
}

Instruction decode_shifted_register(const Encoding& code) {
  const unsigned n = code.bits(0, 4);
  const unsigned d = code.more(8, 4);
  const unsigned m = code.more(0, 4);
  if (code.bits(5, 4) == 6) {
    return decode_packing(code);
  }
  const bool sets_flags = code.bits(4) != 0;
  const Named named = operation_of(code.bits(5, 4), n, d, sets_flags);
  Instruction instruction;
  set_shift(instruction, code);
  const bool is_plain = instruction.amount == 0 && instruction.shift != Shift::rrx;
  const bool is_plain_move = named.operation == Operation::mov && is_plain;
  const bool is_move_of_sp = is_plain_move && !sets_flags && d != program_counter && m != program_counter &&
                             (d != stack_pointer || m != stack_pointer);
  const bool is_far_from_sp =
      d != stack_pointer || is_plain_move || (instruction.shift == Shift::lsl && instruction.amount <= 3);
  const bool is_valid = may_use(named, d, n) && !is_sp_or_pc(m) && is_far_from_sp;
  if (!named.is_known || code.more(15) != 0 || !(is_move_of_sp || is_valid)) {
    return {};
  }
  instruction.execute = execution(named.operation, is_plain ? Operand::plain : Operand::shifted, named.result);
  instruction.d = static_cast<std::uint8_t>(named.result == Result::only_flags ? 0 : d);
  instruction.n = static_cast<std::uint8_t>(n == program_counter ? 0 : n);
  instruction.m = static_cast<std::uint8_t>(m);
  return instruction;
}

Instruction decode_modified_constant(const Encoding& code) {
  const unsigned n = code.bits(0, 4);
  const unsigned d = code.more(8, 4);
  const Named named = operation_of(code.bits(5, 4), n, d, code.bits(4) != 0);
  const Expanded constant = expanded(code);
  if (!named.is_known || !constant.is_valid || !may_use(named, d, n)) {
    return {};
  }
  Instruction instruction = constant_operation(named.operation, named.result,
                                               static_cast<std::uint8_t>(named.result == Result::only_flags ? 0 : d),
                                               static_cast<std::uint8_t>(n == program_counter ? 0 : n), constant.value);
  instruction.option = constant.carry;
  return instruction;
}

Instruction decode_plain_constant(const Encoding& code) {
  const auto n = code.reg(0, 4);
  const std::uint8_t d = code.more_reg(8);
  const std::uint32_t constant = code.bits(10) << 11U | code.more(12, 3) << 8U | code.more(0, 8);
  const std::uint32_t long_constant = std::uint32_t{n} << 12U | constant;
  switch (code.bits(4, 5)) {
    case 0b00000:
    case 0b01010: {
      const bool adds = code.bits(4, 5) == 0;
      if (d == program_counter || (d == stack_pointer && n != stack_pointer)) {
        return {};
      }
      if (n == program_counter) {  // ADR
        const std::uint32_t base = code.pc() & ~3U;
        return constant_operation(Operation::mov, Result::written, d, 0, adds ? base + constant : base - constant);
      }
      return constant_operation(adds ? Operation::add : Operation::sub, Result::written, d, n, constant);
    }
    case 0b00100:
      return is_sp_or_pc(d) ? Instruction{} : constant_operation(Operation::mov, Result::written, d, 0, long_constant);
    case 0b01100: {
      Instruction instruction;
      instruction.execute = is_sp_or_pc(d) ? nullptr : &move_top;
      instruction.d = d;
      instruction.immediate = long_constant;
      return instruction;
    }
    default:
      return decode_saturation_or_field(code);
  }
}

}  // namespace proleg::sim
