#pragma once

// Exception entry and return, and faults (ARMv7-M Architecture Reference Manual, DDI 0403, B1.5.6 to B1.5.15). The
// FPU's registers are not saved.

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/mcu/cpu/cpu_surroundings.hpp"
#include "sim/mcu/cpu/engine.hpp"
#include "sim/mcu/cpu/nvic.hpp"
#include "sim/mcu/cpu/system_control.hpp"

namespace proleg::sim {

class Exceptions {
 public:
  Exceptions(Engine& engine, Nvic& nvic, SystemControl& system_control);

  /// Sets the registers as after a reset. The next instruction is at the address in the reset vector.
  void reset();

  /// Number of the exception that is being handled; 0: thread mode.
  [[nodiscard]] unsigned current() const { return current_; }
  [[nodiscard]] ExceptionMasks masks() const;
  /// Whether the next pending exception preempts what is being executed.
  [[nodiscard]] bool takes_next() const;
  void take_next();
  /// A branch to EXC_RETURN.
  void return_from_handler(std::uint32_t exc_return);
  /// SVC was executed.
  void call_supervisor();

  // Raise a fault of the instruction at Engine::pc().
  void raise_memory_fault(const MemoryFault& fault);
  void raise_undefined_instruction();
  void raise_invalid_state();
  void raise_no_coprocessor();
  void raise_breakpoint();
  void raise_unaligned_access(const MemoryFault& fault);
  void raise_divide_by_zero();

  [[nodiscard]] bool is_locked_up() const { return locked_up_; }
  [[nodiscard]] std::vector<CpuFault> take_faults();
  /// Since the last reset.
  [[nodiscard]] std::uint32_t fault_count() const { return fault_count_; }
  /// Flash has changed.
  void discard_vectors() { vectors_known_.reset(); }
  /// The event register of WFE.
  [[nodiscard]] bool take_event();
  void send_event() { event_ = true; }

 private:
  struct Vector {
    bool exists;
    std::uint32_t address;  ///< with bit 0
  };

  [[nodiscard]] Vector vector(unsigned number);
  void enter(unsigned number);
  /// Enters a handler without saving registers: after tail-chaining, or a fault of the stack itself.
  void enter_without_frame(unsigned number, std::uint32_t exc_return);
  void go_to(const Vector& vector);
  /// Raises a fault, or HardFault in its place.
  void raise(unsigned number, std::uint32_t status, std::string cause);
  void raise_hard_fault(std::uint32_t status);
  [[nodiscard]] bool may_raise(unsigned number) const;
  void note(std::string cause);
  void lock_up();
  void fail_return(unsigned number, std::uint32_t exc_return, std::uint32_t status, std::string cause);
  [[nodiscard]] bool is_valid_return(std::uint32_t exc_return) const;
  void set_mode(unsigned number, std::uint32_t xpsr, std::uint32_t control);

  Engine* engine_;
  Nvic* nvic_;
  SystemControl* system_control_;
  unsigned current_ = 0;
  bool locked_up_ = false;
  bool event_ = false;
  std::uint32_t fault_count_ = 0;
  std::vector<CpuFault> faults_;
  std::uint32_t vector_table_ = 0;
  std::array<std::uint32_t, Nvic::exception_count> vectors_{};
  std::bitset<Nvic::exception_count> vectors_known_;
};

}  // namespace proleg::sim
