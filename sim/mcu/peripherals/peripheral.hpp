#pragma once

// What the parts of a virtual chip know of each other.

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "sim/mcu/cpu/local_time.hpp"

namespace proleg::sim {

/// The program used a register, or a bit of it, that the model does not have, or one in a way that the manual forbids.
/// what() says which and how: "USART2_CR3 = 0x40 at offset 0x14: DMA is not modelled". The chip stops and adds address
/// and place in the program.
class UnmodelledAccess : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Why a chip starts, as RCC_CSR tells it (RM0090, 7.3.21).
enum class ResetCause : std::uint8_t { power_on, pin, software, independent_watchdog };

/// What a peripheral may ask of its chip.
class ChipServices {
 public:
  /// Local time of the access or event that is being worked on.
  [[nodiscard]] virtual LocalTime now() const = 0;
  [[nodiscard]] virtual const Clocks& clocks() const = 0;
  /// The level of an interrupt line into the NVIC (RM0090, table 61). The NVIC pends it while it is high.
  virtual void set_interrupt(unsigned position, bool high) = 0;
  /// The chip starts again from reset, after the instruction that caused it.
  virtual void request_reset(ResetCause cause) = 0;
  /// When this peripheral's next_event() has become earlier outside of a register access.
  virtual void reschedule() = 0;

 protected:
  ~ChipServices() = default;
};

/// A block of registers.
class Peripheral {
 public:
  virtual ~Peripheral() = default;

  /// As the manual writes it: "USART2".
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// First address, and number of bytes up to the end of the block.
  [[nodiscard]] virtual std::uint32_t base() const = 0;
  [[nodiscard]] virtual std::uint32_t size() const = 0;

  /// Whole words; offset: from base(), a multiple of 4. Throw UnmodelledAccess.
  [[nodiscard]] virtual std::uint32_t read(std::uint32_t offset) = 0;
  virtual void write(std::uint32_t offset, std::uint32_t value) = 0;

  /// "USART2_BRR"; for an offset without a register "USART2 at offset 0x4C".
  [[nodiscard]] virtual std::string register_name(std::uint32_t offset) const;

  /// As after a reset of the chip. Does not touch what lies outside (pins, flash contents).
  virtual void reset() = 0;

  /// When it does something by itself next (raises an interrupt, ends an operation); never_on_chip if nothing is due.
  /// It may do so late: every access and every question settles first what was due by ChipServices::now().
  [[nodiscard]] virtual LocalTime next_event() const { return never_on_chip; }
  /// Does what is due at ChipServices::now().
  virtual void advance() {}

  /// Clocks change at ChipServices::now(), from ChipServices::clocks() to `next`: settles what the old ones counted.
  /// Throws UnmodelledAccess if something is under way that the change would spoil.
  virtual void clocks_change(const Clocks& next) { static_cast<void>(next); }
  /// Whether it would be the same with its clock off: nothing counts, converts, sends or listens.
  [[nodiscard]] virtual bool is_idle() const { return next_event() == never_on_chip; }
};

/// The board around the chip: where pins lead.
class BoardSignals {
 public:
  /// Level that the board drives a pin to; nothing if it leaves it open, so that the pull resistors decide.
  [[nodiscard]] virtual std::optional<bool> pin(char port, unsigned number) = 0;
  /// Voltage at an input of ADC1, channels 0 to 15, in microvolts, 0 to 3,300,000 (VDDA).
  [[nodiscard]] virtual std::uint32_t analog_uv(unsigned channel) = 0;
  /// Of the chip, in thousandths of a degree Celsius.
  [[nodiscard]] virtual std::int32_t chip_temperature() = 0;
  /// A byte that a USART has sent, at the end of its stop bit.
  virtual void serial_output(unsigned usart, std::uint8_t byte) = 0;

 protected:
  ~BoardSignals() = default;
};

}  // namespace proleg::sim
