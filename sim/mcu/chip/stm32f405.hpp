#pragma once

// A virtual STM32F405 (ST RM0090): CPU, memory and the peripherals that a joint module uses, on the simulated CAN bus.
// It runs the flashed image, unmodified.
//
// An executed instruction takes one cycle of HCLK; while the CPU sleeps, time jumps to the next event. A program that
// uses what the model does not have stops the chip, with a message that names it.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "sim/bus/bus.hpp"
#include "sim/mcu/cpu/cpu.hpp"
#include "sim/mcu/peripherals/peripheral.hpp"
#include "sim/serial/serial_receiver.hpp"

namespace proleg::sim {

struct ChipSettings {
  std::array<std::uint32_t, 3> unique_id{};
  std::int32_t crystal_parts_per_billion = 0;  ///< of the 8 MHz crystal, against true time
  std::uint64_t seed = 0;                      ///< of what a cut flash operation leaves behind
  unsigned brown_out_level = 3;                ///< option bytes BOR_LEV: 0 to 2: level 3 to 1, 3: off
};

/// An event to report to the user.
struct ChipEvent {
  enum class Kind : std::uint8_t {
    fault,       ///< of the program: an exception handler runs now
    locked_up,   ///< a fault in the handler of a fault
    unmodelled,  ///< the model ends here: the chip stands still until it is switched on again
    reset,       ///< it started again by itself
  };
  Kind kind;
  BusTime time = 0;
  std::string text;
  std::array<std::uint32_t, 17> registers{};  ///< r0-r12, sp, lr, pc, xpsr; of a fault: where it happened
  std::optional<ResetCause> cause;            ///< of a reset
};

class Stm32f405 {
 public:
  /// Attaches to the bus. The chip is off. What it refers to must outlive it.
  Stm32f405(Bus& bus, BoardSignals& board, const ChipSettings& settings);
  ~Stm32f405();
  Stm32f405(const Stm32f405&) = delete;
  Stm32f405& operator=(const Stm32f405&) = delete;

  /// Writes memory, as a programmer on the debug port does. Throws std::out_of_range where no memory is.
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes);
  void read(std::uint32_t address, std::span<std::uint8_t> bytes) const;

  /// Switches it on; if it is on: off and on again.
  void power_on(BusTime now);
  [[nodiscard]] BusTime next_event() const;
  /// Does what is due. Nothing reaches the chip from outside before quiet_until: up to there its program may run ahead.
  void advance_to(BusTime now, BusTime quiet_until);
  /// Does what a program that sleeps does not see, up to this time, which no next_event() precedes: conversions of the
  /// ADC take the signals as they are. To be called before one of them changes, and before pulse_time().
  void catch_up_before(BusTime time);

  // What the chip loses or gets back from outside, at its present time; the state lasts over a reset and power_on().
  /// Whether the crystal oscillates: from the first instruction on if it is set before power_on().
  void set_crystal(bool runs);
  /// Whether the PLL can lock.
  void set_pll(bool locks);
  /// Whether ADC1 converts, or hangs.
  void set_adc(bool converts);
  /// VDD, 3,300 from the start. Below the threshold of the brown-out reset (ChipSettings) or of the power-down reset
  /// the chip is held in reset; below the latter it loses its memory. The analogue supply stays.
  void set_supply(std::uint32_t mv);

  /// The reset pin is pulled low for a moment.
  void pull_reset_pin();

  /// A character begins at the input of USART2, now or a few instructions ago, with the sender's bit time in ns. The
  /// one before must be over. Lost while the chip or its receiver is off.
  void begin_serial_input(BusTime start, const SerialCharacter& character, BusTime bit);
  /// Called with each byte that USART2 sends, and the true time at which its stop bit ends, beside
  /// BoardSignals::serial_output().
  using SerialWatch = std::function<void(BusTime time, std::uint8_t byte)>;
  void set_serial_watch(SerialWatch watch);

  /// Length of the pulses at an output of TIM2 (1 to 4) that reaches its pin, as Timer::high_time(); nothing if there
  /// are none.
  [[nodiscard]] std::optional<LocalTime> pulse_time(unsigned channel) const;
  /// Called when the level of a pin changes, with the true time of its edge. The pin is a plain input or output, or an
  /// output of TIM2; one of another peripheral counts as low. One pin can be watched, before the chip is switched
  /// on.
  using PinWatch = std::function<void(BusTime time, bool high)>;
  void set_pin_watch(char port, unsigned number, PinWatch watch);
  /// Called when the program writes CCR1 of TIM2, with the true time at which the instruction begins.
  using CompareWatch = std::function<void(BusTime time, std::uint32_t counts)>;
  void set_compare_watch(CompareWatch watch);

  /// Index of the controller on the bus.
  [[nodiscard]] std::size_t controller() const;
  /// Executed since the chip was made.
  [[nodiscard]] std::uint64_t instructions() const;
  /// How often the CPU has started since then: after power on, and after each reset.
  [[nodiscard]] std::uint64_t starts() const;

  /// Called when the program asks for a frame to be sent, with the instructions executed by then.
  using TransmitWatch = std::function<void(std::uint16_t identifier, std::uint64_t instructions)>;
  void set_transmit_watch(TransmitWatch watch);

  /// Called when the program has begun an operation of the flash: an erase of the sector at the address, or else a
  /// word.
  using FlashWatch = std::function<void(std::uint32_t address, bool erase)>;
  void set_flash_watch(FlashWatch watch);

  enum class DebugEvent : std::uint8_t {
    about_to_run,
    breakpoint,
    step,   ///< done
    fault,  ///< or lock-up, or what is not modelled
  };
  /// For a debugger: called between instructions; true: the next one alone, then `step`. It may throw.
  using DebugHook = std::function<bool(DebugEvent)>;
  void set_debug_hook(DebugHook hook);
  [[nodiscard]] Cpu& cpu();

  /// The oldest event that was not taken yet.
  [[nodiscard]] std::optional<ChipEvent> take_event();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::sim
