#pragma once

// The state of a Cortex-M4 and its memory, on which instructions work.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "sim/mcu/cpu/code_pages.hpp"
#include "sim/mcu/cpu/cpu_surroundings.hpp"
#include "sim/mcu/cpu/instruction.hpp"

static_assert(std::endian::native == std::endian::little, "the chip's memory is read and written as it is");

namespace proleg::sim {

/// Where memory-mapped registers are, and the words that stand for bits of them and of the RAM (DDI 0403, B3.1).
namespace address_map {
inline constexpr std::uint32_t peripherals_start = 0x4000'0000;
inline constexpr std::uint32_t peripherals_size = 0x2000'0000;
inline constexpr std::uint32_t peripheral_bits_start = 0x4200'0000;
inline constexpr std::uint32_t peripheral_bits_size = 0x0200'0000;
inline constexpr std::uint32_t private_bus_start = 0xE000'0000;
inline constexpr std::uint32_t private_bus_size = 0x0010'0000;
inline constexpr std::uint32_t ram_bits_start = 0x2200'0000;
inline constexpr std::uint32_t ram_bits_size = ChipMemory::ram_size * 32;
}  // namespace address_map

/// What instructions call. These must not throw, nor run the engine.
class EngineClient {
 public:
  /// Peripherals (0x40000000 to 0x5FFFFFFF), private peripheral bus, and the bits of the bit-band regions.
  [[nodiscard]] virtual std::uint32_t load(std::uint32_t address, unsigned size) = 0;
  virtual void store(std::uint32_t address, unsigned size, std::uint32_t value) = 0;
  /// A store to flash. False: rejected.
  [[nodiscard]] virtual bool store_to_flash(std::uint32_t address, unsigned size, std::uint32_t value) = 0;
  /// Called before an instruction if attention was requested or the limit is reached. True: the run ends. False: it has
  /// set a limit that is not reached.
  [[nodiscard]] virtual bool stops() = 0;
  /// Called for a coprocessor instruction: whether it may be executed.
  [[nodiscard]] virtual bool coprocessor_allowed() const = 0;
  /// Called when an address in ChipMemory::reserved_start is written. False: the write is lost; true: it is a fault.
  [[nodiscard]] virtual bool is_forbidden(std::uint32_t address) const = 0;
  /// SEV was executed.
  virtual void send_event() = 0;

 protected:
  ~EngineClient() = default;
};

/// Why a run ended.
enum class End : std::uint8_t {
  none,
  stopped,             ///< the client stopped it
  breakpoint,          ///< before an instruction that has a breakpoint
  stepped,             ///< after one instruction
  wait_for_interrupt,  ///< WFI was executed
  wait_for_event,      ///< WFE was executed
  supervisor_call,     ///< SVC was executed
  exception_return,    ///< a branch to Core::exception_return_value in handler mode was executed
  // The instruction was not executed:
  breakpoint_instruction,  ///< BKPT
  no_coprocessor,          ///< a coprocessor instruction that is not allowed
  floating_point,          ///< one of the FPU that is allowed, which is not modelled
  undefined_instruction,
  invalid_state,     ///< with EPSR.T clear
  unaligned_access,  ///< see fault
  divide_by_zero,
  memory_fault,  ///< see fault
};

/// An access that the memory rejected.
struct MemoryFault {
  std::uint32_t address = 0;
  unsigned size = 0;
  bool is_store = false;
  bool is_fetch = false;
};

/// RAM and flash, by offset.
struct Memory {
  std::array<std::uint8_t, ChipMemory::ram_size> ram;
  std::array<std::uint8_t, ChipMemory::ccm_size> ccm;
  std::array<std::uint8_t, ChipMemory::flash_size> flash;
  std::array<std::uint8_t, ChipMemory::system_memory_size> system;
};

/// N, Z, C and V.
struct ConditionFlags {
  bool negative;
  bool zero;
  bool carry;
  bool overflow;
};

/// Whether a condition, 0 to 15, holds (DDI 0403, A7.3.1).
[[nodiscard]] constexpr bool condition_holds(unsigned condition, const ConditionFlags& flags) {
  const bool is_opposite = (condition & 1U) != 0;
  switch (condition >> 1U) {
    case 0:
      return flags.zero != is_opposite;
    case 1:
      return flags.carry != is_opposite;
    case 2:
      return flags.negative != is_opposite;
    case 3:
      return flags.overflow != is_opposite;
    case 4:
      return (flags.carry && !flags.zero) != is_opposite;
    case 5:
      return (flags.negative == flags.overflow) != is_opposite;
    case 6:
      return (flags.negative == flags.overflow && !flags.zero) != is_opposite;
    default:
      return true;
  }
}

class Core {
 public:
  Core(EngineClient& owner, const InstructionSet& instruction_set)
      : client(owner),
        memory(std::make_unique<Memory>()),
        pages(memory->flash, instruction_set),
        instruction_set_(&instruction_set) {}

  // Registers (DDI 0403, B1.4). Those that instructions use; the program counter is the present instruction.
  std::array<std::uint32_t, 15> r{};  ///< r13 is the stack pointer in use
  std::uint32_t negative = 0;         ///< N: bit 31
  std::uint32_t zero = 1;             ///< Z: set if this is 0
  std::uint32_t carry = 0;            ///< C: 0 or 1
  std::uint32_t overflow = 0;         ///< V: bit 31
  bool saturated = false;             ///< Q
  std::uint8_t greater_equal = 0;     ///< GE
  std::uint8_t it_state = 0;          ///< EPSR.IT: condition and rest of an IT block; 0 outside
  bool thumb = true;                  ///< EPSR.T
  unsigned exception = 0;             ///< IPSR
  std::uint32_t primask = 0;
  std::uint32_t basepri = 0;
  std::uint32_t faultmask = 0;
  std::uint32_t control = 0;
  bool is_exclusive = false;  ///< the monitor of LDREX and STREX

  // The run.
  std::uint64_t limit = 0;         ///< EngineClient::stops() is called from this number of instructions on
  std::uint64_t end_of_chain = 0;  ///< instructions() when `left` is 0
  std::uint32_t left = 0;          ///< instructions that may begin before the engine looks again
  const Instruction* present = nullptr;
  End end = End::none;
  MemoryFault fault;
  std::uint32_t exception_return_value = 0;
  bool traps_unaligned = false;  ///< CCR.UNALIGN_TRP
  bool traps_division = false;   ///< CCR.DIV_0_TRP

  EngineClient& client;
  std::unique_ptr<Memory> memory;
  CodePages pages;

  [[nodiscard]] bool is_privileged() const { return exception != 0 || (control & 1U) == 0; }
  /// The program status register of all bits (DDI 0403, B1.4.2).
  [[nodiscard]] std::uint32_t xpsr() const;
  void set_flags(std::uint32_t value);          ///< N, Z, C, V, Q
  void set_greater_equal(std::uint32_t value);  ///< GE
  void set_xpsr(std::uint32_t value);
  /// The stack pointer of a mode, in use or not.
  [[nodiscard]] std::uint32_t stack_pointer_of(bool is_process) const;
  void set_stack_pointer_of(bool is_process, std::uint32_t value);
  /// To be called when mode or CONTROL has changed.
  void select_stack();

  /// Whether a condition holds.
  [[nodiscard]] bool holds(unsigned condition) const { return condition_holds(condition, flags()); }
  /// The same, for a condition that is not known to the compiler.
  [[nodiscard]] bool holds_now(unsigned condition) const;
  [[nodiscard]] ConditionFlags flags() const {
    return {negative >> 31U != 0, zero == 0, carry != 0, overflow >> 31U != 0};
  }

  void set_negative_and_zero(std::uint32_t result) {
    negative = result;
    zero = result;
  }

  /// Bits 0 and 1 of the stack pointer are always 0 (DDI 0403, B1.4.1).
  void set(unsigned number, std::uint32_t value) { r[number] = number == stack_pointer ? value & ~3U : value; }

  /// The instruction at an even address: in an IT block, if one is being executed.
  [[nodiscard]] const Instruction* at(std::uint32_t address) {
    const std::uint32_t offset = address - ChipMemory::flash_start;
    if (offset < ChipMemory::flash_size) [[likely]] {
      return pages.at(offset, it_state != 0);
    }
    return outside_flash(address);
  }
  /// The same at the begin of a run: with the present EPSR.T.
  [[nodiscard]] const Instruction* begin(std::uint32_t address) { return thumb ? at(address) : outside_flash(address); }
  /// The same, outside IT blocks: the target of a branch.
  [[nodiscard]] const Instruction* branch(std::uint32_t address) {
    const std::uint32_t offset = address - ChipMemory::flash_start;
    if (offset < ChipMemory::flash_size && it_state == 0) [[likely]] {
      return pages.at(offset, false);
    }
    return at(address);
  }
  /// A branch that sets EPSR.T to bit 0 of the address.
  [[nodiscard]] const Instruction* exchange(std::uint32_t address) {
    thumb = (address & 1U) != 0;
    return thumb ? branch(address & ~1U) : outside_flash(address);
  }
  /// BXWritePC (DDI 0403, A2.3.1): the same, or a return from an exception.
  [[nodiscard]] const Instruction* branch_exchange(const Instruction& instruction, std::uint32_t address);

  /// Loads a value of 1, 2 or 4 bytes, extended by zeros. False: a fault.
  template <typename Value>
  [[nodiscard]] bool load(std::uint32_t address, std::uint32_t& value) {
    const std::uint32_t in_ram = address - ChipMemory::ram_start;
    if (in_ram <= ChipMemory::ram_size - sizeof(Value)) [[likely]] {
      return may_access<Value>(address) && fetch<Value>(memory->ram.data() + in_ram, value);
    }
    const std::uint32_t in_flash = address - ChipMemory::flash_start;
    if (in_flash <= ChipMemory::flash_size - sizeof(Value)) {
      return may_access<Value>(address) && fetch<Value>(memory->flash.data() + in_flash, value);
    }
    return load_elsewhere(address, sizeof(Value), value);
  }
  template <typename Value>
  [[nodiscard]] bool store(std::uint32_t address, std::uint32_t value) {
    const std::uint32_t in_ram = address - ChipMemory::ram_start;
    if (in_ram <= ChipMemory::ram_size - sizeof(Value)) [[likely]] {
      if (!may_access<Value>(address)) {
        return false;
      }
      const auto stored = static_cast<Value>(value);
      std::memcpy(memory->ram.data() + in_ram, &stored, sizeof stored);
      return true;
    }
    return store_elsewhere(address, sizeof(Value),
                           sizeof(Value) < 4 ? value & ((1U << 8U * sizeof(Value)) - 1U) : value);
  }
  /// Whether the address of an access that must be aligned is; notes the fault if not.
  [[nodiscard]] bool is_aligned(std::uint32_t address, std::uint32_t size) {
    return (address & (size - 1)) == 0 || note_unaligned(address, size);
  }

  /// Begun, with the present one.
  [[nodiscard]] std::uint64_t instructions() const { return end_of_chain - left; }
  /// Sets how many instructions may begin before the engine looks again.
  void set_left(std::uint32_t count) {
    end_of_chain = instructions() + count;
    left = count;
  }
  /// Executes the next instruction and those behind it while some are left. To be returned by Execute: the compiler
  /// makes a jump of it, so that each kind of instruction has a jump of its own, of which the processor remembers where
  /// it led to.
  [[nodiscard]] const Instruction* go_on(const Instruction* next) {
    return begin_next(next) ? next->execute(*this, *next) : next;
  }
  /// Begins the next instruction if one is left.
  [[nodiscard]] bool begin_next(const Instruction* next) {
    if (left == 0) {
      return false;
    }
    --left;
    present = next;
    return true;
  }
  /// Gives back what set_left(0) has taken, as far as the limit allows.
  void give_back(std::uint32_t count) {
    const std::uint64_t done = instructions();
    set_left(limit > done ? static_cast<std::uint32_t>(std::min<std::uint64_t>(count, limit - done)) : 0);
  }
  /// Ends the run; returns the instruction from which it continues.
  const Instruction* finish(End why, const Instruction* next) {
    end = why;
    attend();
    return next;
  }
  /// The client is asked before the next instruction.
  void attend() {
    limit = 0;
    set_left(0);
  }

 private:
  template <typename Value>
  [[nodiscard]] static bool fetch(const std::uint8_t* place, std::uint32_t& value) {
    Value fetched = 0;
    std::memcpy(&fetched, place, sizeof fetched);
    value = fetched;
    return true;
  }
  template <typename Value>
  [[nodiscard]] bool may_access(std::uint32_t address) {
    return sizeof(Value) == 1 || !traps_unaligned || is_aligned(address, sizeof(Value));
  }
  // These note a fault; false.
  [[nodiscard]] bool note_unaligned(std::uint32_t address, std::uint32_t size);
  [[nodiscard]] bool note_fault(std::uint32_t address, unsigned size, bool is_store);
  [[nodiscard]] bool load_elsewhere(std::uint32_t address, unsigned size, std::uint32_t& value);
  [[nodiscard]] bool store_elsewhere(std::uint32_t address, unsigned size, std::uint32_t value);
  [[nodiscard]] const Instruction* outside_flash(std::uint32_t address);

  const InstructionSet* instruction_set_;
  std::uint32_t other_stack_pointer_ = 0;
  bool uses_process_stack_ = false;
  /// An instruction outside the flash, and what leads to the one behind it.
  std::array<Instruction, 3> single_;
};

}  // namespace proleg::sim
