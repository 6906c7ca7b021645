#pragma once

// When the program cannot continue, it writes what is known about the fault into a record in RAM that survives a reset,
// and resets the chip. The next start reads the record once.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace proleg::stm32f405 {

struct FaultRecord {
  enum class Reason : std::uint32_t {
    processor_fault,       ///< HardFault, to which bus, usage and memory faults escalate: CFSR distinguishes them
    non_maskable,          ///< NMI, but not from the clock security system
    unexpected_interrupt,  ///< an interrupt that the program does not enable
    pure_virtual_call,
    no_crystal,  ///< the crystal (HSE) did not start: without it there is no CAN
    no_pll,
    no_can,           ///< the controller does not enter its initialization mode
    pll_unlocked,     ///< the PLL lost its lock while it was in use: all clocks had an unknown frequency
    crystal_stopped,  ///< the crystal (HSE) stopped while it was in use: all clocks had the wrong frequency
    supply_failed,    ///< the supply is too low for the clocks (Supply::Level::none)
  };

  Reason reason = Reason::processor_fault;
  std::uint32_t exception = 0;  ///< IPSR: number of the exception whose handler was entered
  /// r0, r1, r2, r3, r12, lr, pc, xPSR as the exception found them (PM0214, section 2.3.7); 0 if the stack was lost.
  std::array<std::uint32_t, 8> frame{};
  std::uint32_t stack_pointer = 0;
  std::uint32_t configurable_status = 0;  ///< CFSR
  std::uint32_t hard_fault_status = 0;    ///< HFSR
  std::uint32_t address = 0;              ///< address that was accessed, if CFSR says that it is known

  [[nodiscard]] std::uint32_t lr() const { return frame[5]; }
  [[nodiscard]] std::uint32_t pc() const { return frame[6]; }
};

/// Whether a clock of the chip has failed, and not the program.
[[nodiscard]] constexpr bool is_clock_failure(FaultRecord::Reason reason) {
  using Reason = FaultRecord::Reason;
  return reason == Reason::no_crystal || reason == Reason::no_pll || reason == Reason::pll_unlocked ||
         reason == Reason::crystal_stopped;
}

/// Forbids accesses to the 4 KiB below the stack, with the MPU: what the chip does there is not documented. Must be
/// called once. A stack overflow then locks the processor up (the fault finds no stack either), and the watchdog resets
/// the chip.
void guard_stack();

/// Text for the console that describes the reason.
[[nodiscard]] std::string_view text_of(FaultRecord::Reason reason);

/// Record of the last fault, if there was one since the last call; the call deletes it.
[[nodiscard]] std::optional<FaultRecord> take_fault_record();

/// Writes a record with the caller's address as pc. The caller must reset the chip.
[[gnu::noinline]] void record_fault(FaultRecord::Reason reason);

}  // namespace proleg::stm32f405
