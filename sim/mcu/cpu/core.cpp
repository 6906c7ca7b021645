#include "sim/mcu/cpu/core.hpp"

#include <utility>

#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::sim {
namespace {

// Bits of xPSR (DDI 0403, B1.4.2).
constexpr unsigned negative_bit = 31;
constexpr unsigned zero_bit = 30;
constexpr unsigned carry_bit = 29;
constexpr unsigned overflow_bit = 28;
constexpr unsigned saturated_bit = 27;
constexpr unsigned it_low_bits = 25;  ///< bits 0 and 1 of EPSR.IT
constexpr unsigned greater_equal_bits = 16;
constexpr unsigned it_high_bits = 10;  ///< bits 2 to 7

bool is_register(std::uint32_t address) {
  using namespace address_map;
  return address - peripherals_start < peripherals_size || address - private_bus_start < private_bus_size ||
         address - ram_bits_start < ram_bits_size;
}

/// By condition: bits by the flags N, Z, C and V as a number, in which V is bit 0.
constexpr auto flags_for_condition = [] {
  std::array<std::uint16_t, 16> sets{};
  for (unsigned condition = 0; condition < sets.size(); ++condition) {
    for (unsigned flags = 0; flags < 16; ++flags) {
      const ConditionFlags each{(flags & 8U) != 0, (flags & 4U) != 0, (flags & 2U) != 0, (flags & 1U) != 0};
      if (condition_holds(condition, each)) {
        sets.at(condition) = static_cast<std::uint16_t>(sets.at(condition) | 1U << flags);
      }
    }
  }
  return sets;
}();

}  // namespace

bool Core::holds_now(unsigned condition) const {
  const unsigned flags = negative >> 31U << 3U | (zero == 0 ? 4U : 0U) | carry << 1U | overflow >> 31U;
  return (flags_for_condition[condition] >> flags & 1U) != 0;
}

std::uint32_t Core::xpsr() const {
  return (negative >> 31U) << negative_bit | (zero == 0 ? 1U : 0U) << zero_bit | carry << carry_bit |
         (overflow >> 31U) << overflow_bit | (saturated ? 1U : 0U) << saturated_bit | (it_state & 3U) << it_low_bits |
         (thumb ? thumb_state : 0U) | std::uint32_t{greater_equal} << greater_equal_bits |
         (it_state & ~3U) >> 2U << it_high_bits | exception;
}

void Core::set_flags(std::uint32_t value) {
  negative = value;
  zero = ~value >> zero_bit & 1U;
  carry = value >> carry_bit & 1U;
  overflow = value << (negative_bit - overflow_bit);
  saturated = (value >> saturated_bit & 1U) != 0;
}

void Core::set_greater_equal(std::uint32_t value) {
  greater_equal = static_cast<std::uint8_t>(value >> greater_equal_bits & 0xFU);
}

void Core::set_xpsr(std::uint32_t value) {
  set_flags(value);
  set_greater_equal(value);
  it_state = static_cast<std::uint8_t>((value >> it_low_bits & 3U) | (value >> it_high_bits & 0x3FU) << 2U);
  thumb = (value & thumb_state) != 0;
  exception = value & exception_number_mask;
  select_stack();
}

std::uint32_t Core::stack_pointer_of(bool is_process) const {
  return is_process == uses_process_stack_ ? r[stack_pointer] : other_stack_pointer_;
}

void Core::set_stack_pointer_of(bool is_process, std::uint32_t value) {
  (is_process == uses_process_stack_ ? r[stack_pointer] : other_stack_pointer_) = value & ~3U;
}

void Core::select_stack() {
  const bool is_process = exception == 0 && (control & 2U) != 0;
  if (is_process != uses_process_stack_) {
    std::swap(r[stack_pointer], other_stack_pointer_);
    uses_process_stack_ = is_process;
  }
}

const Instruction* Core::branch_exchange(const Instruction& instruction, std::uint32_t address) {
  if (exception != 0 && address >= 0xF000'0000) {
    exception_return_value = address;
    return finish(End::exception_return, after(instruction));
  }
  return exchange(address);
}

const Instruction* Core::outside_flash(std::uint32_t address) {
  const std::uint32_t even = address & ~1U;
  if (!thumb) {
    single_[0] = instruction_set_->invalid_state(even);
    return single_.data();
  }
  const std::uint32_t offset = even - ChipMemory::ram_start;
  if (offset > ChipMemory::ram_size - 2) {
    single_[0] = instruction_set_->fetch_fault(even);
    return single_.data();
  }
  const std::uint8_t* const place = memory->ram.data() + offset;
  const std::uint32_t rest = ChipMemory::ram_size - offset;
  Encoding code;
  code.address = even;
  code.first = halfword_at({place, 2}, 0);
  code.second = rest >= 4 ? halfword_at({place, 4}, 2) : std::uint16_t{0};
  code.in_it_block = it_state != 0;
  single_[0] = instruction_set_->decode(code);
  // Decoded anew each time, since a program may have written it.
  single_[single_[0].halfwords] = instruction_set_->continuation(even + 2U * single_[0].halfwords);
  return single_.data();
}

bool Core::note_unaligned(std::uint32_t address, std::uint32_t size) {
  fault = {address, size, false, false};
  finish(End::unaligned_access, nullptr);
  return false;
}

bool Core::note_fault(std::uint32_t address, unsigned size, bool is_store) {
  fault = {address, size, is_store, false};
  finish(End::memory_fault, nullptr);
  return false;
}

bool Core::load_elsewhere(std::uint32_t address, unsigned size, std::uint32_t& value) {
  const auto take = [&](const std::uint8_t* place) {
    value = 0;
    std::memcpy(&value, place, size);
    return true;
  };
  if ((traps_unaligned || is_register(address)) && !is_aligned(address, size)) {
    return false;
  }
  if (const std::uint32_t offset = address - ChipMemory::ccm_start; offset <= ChipMemory::ccm_size - size) {
    return take(memory->ccm.data() + offset);
  }
  if (const std::uint32_t offset = address - ChipMemory::system_memory_start;
      offset <= ChipMemory::system_memory_size - size) {
    return take(memory->system.data() + offset);
  }
  if (is_register(address)) {
    value = client.load(address, size);
    return true;
  }
  if (address - ChipMemory::reserved_start < ChipMemory::reserved_size && !client.is_forbidden(address)) {
    value = 0;
    return true;
  }
  return note_fault(address, size, false);
}

bool Core::store_elsewhere(std::uint32_t address, unsigned size, std::uint32_t value) {
  if ((traps_unaligned || is_register(address)) && !is_aligned(address, size)) {
    return false;
  }
  if (const std::uint32_t offset = address - ChipMemory::ccm_start; offset <= ChipMemory::ccm_size - size) {
    std::memcpy(memory->ccm.data() + offset, &value, size);
    return true;
  }
  if (is_register(address)) {
    client.store(address, size, value);
    return true;
  }
  const bool is_flash = address - ChipMemory::flash_start <= ChipMemory::flash_size - size;
  const bool is_lost =
      address - ChipMemory::reserved_start < ChipMemory::reserved_size && !client.is_forbidden(address);
  if (is_lost || (is_flash && client.store_to_flash(address, size, value))) {
    return true;
  }
  return note_fault(address, size, true);
}

}  // namespace proleg::sim
