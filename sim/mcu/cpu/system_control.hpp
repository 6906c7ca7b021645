#pragma once

// The registers on the private peripheral bus: System Control Block, SysTick, NVIC, and of the debug units the cycle
// counter (ARMv7-M Architecture Reference Manual, DDI 0403, B3.2 to B3.4 and C1.8).

#include <cstdint>
#include <string>

#include "sim/mcu/cpu/cpu_surroundings.hpp"
#include "sim/mcu/cpu/memory_protection.hpp"
#include "sim/mcu/cpu/nvic.hpp"
#include "sim/mcu/cpu/system_tick.hpp"

namespace proleg::sim {

/// The cycle counter CYCCNT of the DWT (ARMv7-M Architecture Reference Manual, DDI 0403, C1.8). An instruction is a
/// cycle; `now`: instructions executed so far.
class CycleCounter {
 public:
  /// DWT_CTRL.
  [[nodiscard]] std::uint32_t control() const { return control_; }
  void write_control(std::uint32_t value, std::uint64_t now) {
    const std::uint32_t cycles = this->value(now);
    control_ = (control_ & ~cycle_enable) | (value & cycle_enable);
    write_value(cycles, now);
  }
  /// DEMCR.
  [[nodiscard]] std::uint32_t debug_control() const { return debug_control_; }
  void write_debug_control(std::uint32_t value, std::uint64_t now) {
    const std::uint32_t cycles = this->value(now);
    debug_control_ = value & trace_enable;
    write_value(cycles, now);
  }
  /// DWT_CYCCNT.
  [[nodiscard]] std::uint32_t value(std::uint64_t now) const {
    const bool counts = (control_ & cycle_enable) != 0 && (debug_control_ & trace_enable) != 0;
    return counts ? static_cast<std::uint32_t>(now - base_) : stopped_value_;
  }
  void write_value(std::uint32_t value, std::uint64_t now) {
    stopped_value_ = value;
    base_ = now - value;
  }

 private:
  static constexpr std::uint32_t cycle_enable = 1;          ///< DWT_CTRL.CYCCNTENA
  static constexpr std::uint32_t trace_enable = 1U << 24U;  ///< DEMCR.TRCENA

  std::uint32_t control_ = 0x4000'0000;  ///< NUMCOMP = 4
  std::uint32_t debug_control_ = 0;
  std::uint64_t base_ = 0;           ///< instructions when it was 0, while it counts
  std::uint32_t stopped_value_ = 0;  ///< while it does not
};

/// What the registers need of the CPU around them.
class SystemControlOwner {
 public:
  [[nodiscard]] virtual LocalTime now() const = 0;
  [[nodiscard]] virtual LocalTime core_period() const = 0;
  [[nodiscard]] virtual std::uint64_t instructions() const = 0;
  /// Number of the exception that is being handled.
  [[nodiscard]] virtual unsigned active_exception() const = 0;
  /// What is pending may have changed.
  virtual void attend() = 0;
  /// SystemTick::next_exception() may be earlier than before.
  virtual void reschedule() = 0;
  virtual void request_reset() = 0;
  /// The CPU stops at something that is not modelled.
  virtual void halt(std::string reason) = 0;

 protected:
  ~SystemControlOwner() = default;
};

class SystemControl {
 public:
  static constexpr std::uint32_t start = 0xE000'0000;
  static constexpr std::uint32_t end = 0xE010'0000;

  SystemControl(SystemControlOwner& owner, Nvic& nvic) : owner_(&owner), nvic_(&nvic) {}

  void reset();

  /// size: 1, 2 or 4.
  [[nodiscard]] std::uint32_t load(std::uint32_t address, unsigned size);
  void store(std::uint32_t address, unsigned size, std::uint32_t value);

  /// Address of the vector table.
  [[nodiscard]] std::uint32_t vector_table() const { return vector_table_; }
  [[nodiscard]] bool sleeps_on_exit() const { return (control_ & 2U) != 0; }
  /// CCR.UNALIGN_TRP, CCR.DIV_0_TRP.
  [[nodiscard]] bool traps_unaligned() const { return (configuration_ & 8U) != 0; }
  [[nodiscard]] bool traps_division_by_zero() const { return (configuration_ & 0x10U) != 0; }
  /// CCR.STKALIGN, CCR.NONBASETHRDENA.
  [[nodiscard]] bool aligns_stack() const { return (configuration_ & 0x200U) != 0; }
  [[nodiscard]] bool allows_any_thread_entry() const { return (configuration_ & 1U) != 0; }
  /// CPACR: full access, or access and privileged.
  [[nodiscard]] bool fpu_enabled(bool privileged) const;

  // Fault status (DDI 0403, B3.2.15 to B3.2.18).
  void note_configurable(std::uint32_t bits) { configurable_status_ |= bits; }
  void note_hard(std::uint32_t bits) { hard_status_ |= bits; }
  void set_bus_fault_address(std::uint32_t address) { bus_fault_address_ = address; }
  void set_memory_fault_address(std::uint32_t address) { memory_fault_address_ = address; }
  [[nodiscard]] const MemoryProtection& protection() const { return protection_; }

  [[nodiscard]] SystemTick& system_tick() { return system_tick_; }
  [[nodiscard]] const SystemTick& system_tick() const { return system_tick_; }
  /// Pends the exception of SysTick if it is due.
  void collect_system_tick();

 private:
  [[nodiscard]] std::uint32_t read_word(std::uint32_t address);
  void write_word(std::uint32_t address, std::uint32_t value);
  /// One byte of a register that may be written by bytes; false: it may not.
  [[nodiscard]] bool write_byte(std::uint32_t address, std::uint8_t value);

  [[nodiscard]] std::uint32_t interrupt_control_state() const;
  void write_interrupt_control_state(std::uint32_t value);
  void write_application_interrupt_control(std::uint32_t value);
  [[nodiscard]] std::uint32_t handler_control() const;
  void write_handler_control(std::uint32_t value);
  [[nodiscard]] std::uint32_t interrupts(std::uint32_t word, bool (Nvic::*is)(unsigned) const) const;
  void change_interrupts(std::uint32_t word, std::uint32_t value, void (Nvic::*change)(unsigned, bool), bool to);
  void halt(std::uint32_t address, const char* what);
  void check_protection();

  SystemControlOwner* owner_;
  Nvic* nvic_;
  SystemTick system_tick_;
  std::uint32_t vector_table_ = 0;
  std::uint32_t control_ = 0;
  std::uint32_t configuration_ = 0x200;
  std::uint32_t configurable_status_ = 0;
  std::uint32_t hard_status_ = 0;
  std::uint32_t memory_fault_address_ = 0;
  MemoryProtection protection_;
  std::uint32_t bus_fault_address_ = 0;
  std::uint32_t auxiliary_control_ = 0;
  std::uint32_t coprocessor_access_ = 0;
  CycleCounter cycle_counter_;
};

}  // namespace proleg::sim
