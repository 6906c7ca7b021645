#pragma once

// A Cortex-M4 (ARMv7-M Architecture Reference Manual, DDI 0403) with its memory: executes a program, takes interrupts
// and faults.
//
// It differs from the chip in this:
// - An instruction takes one cycle. DWT_CYCCNT counts instructions. An interrupt is taken before the next instruction.
// - Nothing is at address 0, where the chip shows the flash a second time; only the vector table is found there. So a
//   null pointer is a fault.
// - The MPU guards the stack only (memory_protection.hpp); unprivileged code may use everything except the special
//   registers.
// - There is no FPU: its instructions halt the CPU if CPACR allows them.
// - What the manual calls UNPREDICTABLE is an undefined instruction, and an unaligned access to registers a fault.
// - A store that the bus rejects is a precise fault.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {

class Cpu {
 public:
  /// Memory is that of a new chip: flash is erased (0xFF), RAM holds noise. The CPU is halted
  /// until the first reset(). The surroundings must outlive it.
  explicit Cpu(CpuSurroundings& surroundings);
  ~Cpu();
  Cpu(const Cpu&) = delete;
  Cpu& operator=(const Cpu&) = delete;

  /// The power was off: RAM and core-coupled memory hold noise, which follows from the seed. Before the next reset().
  void lose_memory(std::uint64_t seed);

  /// Starts from reset: stack pointer and first address from the vector table at the start of the flash. RAM keeps its
  /// contents. A vector table without a valid address is a fault at the first run().
  void reset();

  enum class State : std::uint8_t {
    running,   ///< can execute
    sleeping,  ///< WFI or WFE: until an interrupt is pending
    paused,    ///< pause() was called, or the program has requested a reset
    at_breakpoint,
    locked_up,  ///< by a fault in the handler of a fault: until reset()
    halted,     ///< halt() was called, or the program used what is not modelled: until reset()
  };

  /// Executes this many instructions, at least one if the CPU runs. Ends earlier when it sleeps, pauses, halts or locks
  /// up, and, still running, when the program has set SysTick, so that next_system_tick() may have changed. Interrupts
  /// that are pending are taken.
  State run(std::uint64_t instructions);
  [[nodiscard]] State state() const;
  /// Executed since the CPU was made, with those that an IT block skips, since they take time on the M4. In a callback:
  /// with the present one.
  [[nodiscard]] std::uint64_t instructions() const;

  /// run() ends before the next instruction.
  void pause();
  /// Shortens the present run(): it ends when instructions() has reached this number.
  void limit(std::uint64_t instructions);
  /// Ends it until reset(), before the next instruction; for what is not modelled.
  void halt(std::string reason = {});
  /// The reason of the first halt() since reset(): one line that names what was found; empty if there was none.
  [[nodiscard]] const std::string& halt_reason() const;

  /// The level of a line to the NVIC, position 0 to 81 (RM0090, table 61). It pends when it rises, and again if it is
  /// still high when its handler returns.
  void set_interrupt(unsigned position, bool high);
  /// The level of the line of NMI, in the same way.
  void set_non_maskable(bool high);
  /// Whether an interrupt is pending that would wake the CPU from WFI.
  [[nodiscard]] bool wakes() const;
  /// When SysTick pends its exception next; never_on_chip if it does not.
  [[nodiscard]] LocalTime next_system_tick() const;
  /// To be called when time has reached next_system_tick().
  void advance_system_tick();
  /// To be called when CpuSurroundings::core_period() has changed.
  void change_core_period();

  /// Any memory but registers; throws std::out_of_range for an address without memory. A write to flash in a callback
  /// reaches the program with the next instruction.
  void read(std::uint32_t address, std::span<std::uint8_t> bytes) const;
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes);

  /// r0-r12, sp, lr, pc, xpsr: 0 to 16. In a callback, pc is that of the present instruction.
  [[nodiscard]] std::uint32_t core_register(unsigned number) const;
  void set_core_register(unsigned number, std::uint32_t value);
  /// Number of the exception being handled, 0 in thread mode.
  [[nodiscard]] unsigned active_exception() const;

  /// Execution ends before these addresses, also those in an IT block that are skipped. A run after one that ended at a
  /// breakpoint passes it.
  void set_breakpoints(std::span<const std::uint32_t> addresses);
  /// Executes a single instruction, after an exception entry if one is due.
  void step();

  /// Faults since the last call, oldest first: what led to a HardFault (or another fault handler) or a lock-up.
  [[nodiscard]] std::vector<CpuFault> take_faults();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::sim
