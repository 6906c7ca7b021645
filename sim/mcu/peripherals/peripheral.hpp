#pragma once

// The interfaces between the parts of a virtual chip.

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "shared/computer/text/text.hpp"
#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {

/// The program used a register, or a bit of one, that the model does not have, or used it in a way that the manual
/// forbids. what() names both: "USART2_CR3 = 0x40 at offset 0x14: DMA is not modelled". The chip stops and adds address
/// and place in the program.
class UnmodelledAccess : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Causes of a chip's start, which RCC_CSR shows (RM0090, 7.3.21).
enum class ResetCause : std::uint8_t { power_on, brown_out, pin, software, independent_watchdog };

/// Services of a chip for its peripherals.
class ChipServices {
 public:
  /// Local time of the present access or event.
  [[nodiscard]] virtual LocalTime now() const = 0;
  [[nodiscard]] virtual const Clocks& clocks() const = 0;
  /// Sets the level of an interrupt line into the NVIC (RM0090, table 61). The NVIC pends it while it is high.
  virtual void set_interrupt(unsigned position, bool high) = 0;
  /// Sets the level of the line of NMI, which RCC drives (RM0090, 7.2.7).
  virtual void set_non_maskable(bool high) = 0;
  /// Resets the chip after the instruction that caused the reset.
  virtual void request_reset(ResetCause cause) = 0;
  /// To be called when this peripheral's next_event() has become earlier outside of a register access.
  virtual void reschedule() = 0;

 protected:
  ~ChipServices() = default;
};

/// A block of registers.
class Peripheral {
 public:
  virtual ~Peripheral() = default;

  /// Name as the manual writes it: "USART2".
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// First address, and number of bytes up to the end of the block.
  [[nodiscard]] virtual std::uint32_t base() const = 0;
  [[nodiscard]] virtual std::uint32_t size() const = 0;

  /// Read or write a whole word; offset: from base(), a multiple of 4. Throw UnmodelledAccess.
  [[nodiscard]] virtual std::uint32_t read(std::uint32_t offset) = 0;
  virtual void write(std::uint32_t offset, std::uint32_t value) = 0;

  /// Name of a register: "USART2_BRR"; for an offset without a register "USART2 at offset 0x4C".
  [[nodiscard]] virtual std::string register_name(std::uint32_t offset) const {
    return std::string(name()) + " at offset " + hexadecimal(offset);
  }

  /// Sets the registers as after a reset of the chip. Does not change pins and flash contents.
  virtual void reset() = 0;

  /// Time at which it next acts by itself (raises an interrupt, ends an operation); never_on_chip if nothing is due.
  /// advance() may come late: each access first does what was due by ChipServices::now().
  [[nodiscard]] virtual LocalTime next_event() const { return never_on_chip; }
  /// Does what is due at ChipServices::now().
  virtual void advance() {}
  /// Time of the next event that not only the program can see: it raises an interrupt, reaches a pin, or leaves the
  /// model. Events before it change only registers and memory. While the CPU sleeps, advance() may come late for these,
  /// and does each as of its own time.
  [[nodiscard]] virtual LocalTime next_visible_event() const { return next_event(); }

  /// Clocks change at ChipServices::now(), from ChipServices::clocks() to `next`: counts up to now with the old ones.
  /// Throws UnmodelledAccess if the change would spoil an operation under way.
  virtual void clocks_change(const Clocks& next) { static_cast<void>(next); }
  /// Clocks change because an oscillator has failed or runs again. Operations under way are lost.
  virtual void clocks_fail(const Clocks& next) { clocks_change(next); }
  /// Whether it does nothing that needs its clock: it does not count, convert, send or receive.
  [[nodiscard]] virtual bool is_idle() const { return next_event() == never_on_chip; }
};

/// The board around the chip, to which its pins are connected.
class BoardSignals {
 public:
  /// Level that the board drives a pin to; nothing if it leaves it open, so that the pull resistors decide.
  [[nodiscard]] virtual std::optional<bool> pin(char port, unsigned number) = 0;
  /// Voltage at an input of ADC1, channels 0 to 15, in microvolts, 0 to 3,300,000 (VDDA).
  [[nodiscard]] virtual std::uint32_t analog_uv(unsigned channel) = 0;
  /// Temperature of the chip, in thousandths of a degree Celsius.
  [[nodiscard]] virtual std::int32_t chip_temperature() = 0;
  /// Takes a byte that a USART has sent, at the end of its stop bit.
  virtual void serial_output(unsigned usart, std::uint8_t byte) = 0;

 protected:
  ~BoardSignals() = default;
};

}  // namespace proleg::sim
