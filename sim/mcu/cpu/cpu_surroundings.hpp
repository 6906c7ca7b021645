#pragma once

// What the parts of a CPU and their users share: its time, where its memory is, what lies around it, and its faults.

#include <cstdint>
#include <string>
#include <vector>

namespace proleg::sim {

/// Time on a chip's own crystal since its power-on, in units of 1/1008 us. Every clock that this chip family uses (HSI
/// 16 MHz, HSE 8 MHz, 168, 84, 42, 48 MHz ...) divides 1,008 MHz, so that periods are whole numbers and nothing is
/// rounded.
using LocalTime = std::uint64_t;
inline constexpr LocalTime local_time_per_us = 1008;
/// An event that never comes.
inline constexpr LocalTime never_on_chip = ~LocalTime{0};

/// Periods of a chip's clocks, as RCC has set them (RM0090, section 7). At reset: HSI.
struct Clocks {
  static constexpr LocalTime hsi = local_time_per_us / 16;
  LocalTime core = hsi;         ///< HCLK: one instruction takes one of these
  LocalTime apb1 = hsi;         ///< clock of CAN1 and USART2
  LocalTime apb2 = hsi;         ///< clock of ADC1
  LocalTime apb1_timers = hsi;  ///< clock of TIM2 and TIM5
  LocalTime apb2_timers = hsi;
};

/// The memory of a chip, by address.
struct ChipMemory {
  static constexpr std::uint32_t flash_start = 0x0800'0000;
  static constexpr std::uint32_t flash_size = 1024 * 1024;
  static constexpr std::uint32_t ram_start = 0x2000'0000;
  static constexpr std::uint32_t ram_size = 128 * 1024;
  static constexpr std::uint32_t ccm_start = 0x1000'0000;  ///< core-coupled memory
  static constexpr std::uint32_t ccm_size = 64 * 1024;
  static constexpr std::uint32_t system_memory_start = 0x1FFF'0000;  ///< with unique id and calibration values
  static constexpr std::uint32_t system_memory_size = 32 * 1024;
  /// Addresses just below the RAM, which RM0090 reserves (2.3). What an access does is not documented: here a write is
  /// lost without a fault, unless the MPU forbids it.
  static constexpr std::uint32_t reserved_start = 0x1FFF'F000;
  static constexpr std::uint32_t reserved_size = 4 * 1024;
};

/// What lies behind the CPU's addresses, other than memory and its own system registers.
class CpuSurroundings {
 public:
  /// An access in 0x40000000 to 0x5FFFFFFF, of 1, 2 or 4 bytes; one to a bit-band alias arrives as load and store of
  /// the word. These are called by an instruction: they must not throw, and may use all functions of the CPU
  /// except reset(), run(), step(), set_breakpoints() and set_core_register().
  [[nodiscard]] virtual std::uint32_t load(std::uint32_t address, unsigned size) = 0;
  virtual void store(std::uint32_t address, unsigned size, std::uint32_t value) = 0;
  /// A store to flash, which changes nothing by itself: Cpu::write() does. False: the bus rejects it, a fault of the
  /// program.
  [[nodiscard]] virtual bool store_to_flash(std::uint32_t address, unsigned size, std::uint32_t value) = 0;
  /// For SysTick: local time and period of its clock (HCLK).
  [[nodiscard]] virtual LocalTime now() const = 0;
  [[nodiscard]] virtual LocalTime core_period() const = 0;
  /// SYSRESETREQ. The run ends before the next instruction; the caller of run() must call reset().
  virtual void reset_requested() = 0;

 protected:
  ~CpuSurroundings() = default;
};

/// What went wrong, and the registers before the instruction that did it.
struct CpuFault {
  std::string cause;  ///< "store to 0x20030000, where there is no memory", "undefined instruction" ...
  std::vector<std::uint32_t> registers;  ///< r0-r12, sp, lr, pc, xpsr
  bool locked_up = false;                ///< a fault within HardFault or NMI: the CPU stands still
};

// The frame of registers that an exception saves on the stack (DDI 0403, B1.5.6).
inline constexpr std::uint32_t frame_size = 32;  ///< bytes
// Bits of the saved xPSR.
inline constexpr std::uint32_t thumb_state = 1U << 24U;
inline constexpr std::uint32_t frame_was_aligned = 1U << 9U;
inline constexpr std::uint32_t exception_number_mask = 0x1FF;

}  // namespace proleg::sim
