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
#include "sim/serial/serial_line.hpp"

namespace proleg::sim {

struct ChipSettings {
  std::array<std::uint32_t, 3> unique_id{};
  std::int32_t crystal_parts_per_billion = 0;  ///< error of the crystal against true time
  std::uint64_t seed = 0;                      ///< of the bits that a cut flash operation leaves
  unsigned brown_out_level = 3;                ///< option bytes BOR_LEV: 0 to 2: level 3 to 1, 3: off
  std::uint32_t crystal = 8'000'000;           ///< Hz
};

/// An event to report to the user.
struct ChipEvent {
  enum class Kind : std::uint8_t {
    fault,       ///< fault of the program: an exception handler runs now
    locked_up,   ///< a fault in the handler of a fault
    unmodelled,  ///< the model ends here: the chip stands still until it is switched on again
    reset,       ///< the chip started again by itself
  };
  Kind kind;
  BusTime time = 0;
  std::string text;
  std::array<std::uint32_t, 17> registers{};  ///< r0-r12, sp, lr, pc, xpsr; of a fault: at its place
  std::optional<ResetCause> cause;            ///< cause of a reset
};

class Stm32f405 {
 public:
  /// Attaches to the bus. The chip is off. Bus and board must outlive it.
  Stm32f405(Bus& bus, BoardSignals& board, const ChipSettings& settings);
  ~Stm32f405();
  Stm32f405(const Stm32f405&) = delete;
  Stm32f405& operator=(const Stm32f405&) = delete;

  /// Writes memory, as a programmer on the debug port does. Throws std::out_of_range if an address has no memory.
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes);
  void read(std::uint32_t address, std::span<std::uint8_t> bytes) const;

  /// Switches the chip on; if it is on, off and on again.
  void power_on(BusTime now);
  [[nodiscard]] BusTime next_event() const;
  /// Does what is due. Nothing reaches the chip from outside before quiet_until: its program may run ahead up to this
  /// time.
  void advance_to(BusTime now, BusTime quiet_until);

  // The same in two parts.
  /// Time of the first request of the program to the bus that waits for submit(); never_on_bus if none does.
  [[nodiscard]] BusTime next_request() const;
  /// Takes the requests of times up to now to the bus, whose time must be now.
  void submit(BusTime now);
  /// Does the rest of advance_to(from, quiet_until). Uses nothing outside of the chip but what a thread may use between
  /// Bus::begin_sharing() and end_sharing(), the BoardSignals and the watches. May be called again with a later
  /// quiet_until: the result is that of one call. ends_before_restart: it ends where the program restarts the chip, and
  /// then returns false.
  bool run(BusTime from, BusTime quiet_until, bool ends_before_restart = false);

  /// Does what a program that sleeps does not see, up to a time before which next_event() has nothing: conversions of
  /// the ADC take the present signals. To be called before a signal changes, and before pulse_time().
  void catch_up_before(BusTime time);

  // Failures from outside at the chip's present time, and their ends; the state lasts over a reset and power_on().
  /// Sets whether the crystal oscillates: from the first instruction on if it is set before power_on().
  void set_crystal(bool runs);
  /// Sets whether the PLL can lock.
  void set_pll(bool locks);
  /// Sets whether DMA reaches the data register of ADC1 (Adc::set_dma_reach()).
  void set_adc(bool is_read);
  /// Ends the DMA stream of ADC1 with a transfer error (Dma::fail()).
  void fail_dma_of_adc();
  /// Makes a word of the flash weak (FlashInterface::set_weak_word()).
  void set_weak_word(std::uint32_t address, std::uint32_t bits);
  /// Sets VDD, 3,300 mV at the start. Below the threshold of the brown-out reset (ChipSettings) or of the power-down
  /// reset the chip is held in reset; below the latter it loses its memory. The analogue supply stays. A chip whose
  /// clock is too fast for its flash at this voltage stops, with an event (FlashInterface::speed_fault()).
  void set_supply(std::uint32_t mv);

  /// Pulls the reset pin low for a moment.
  void pull_reset_pin();

  /// A character begins at the input of USART2, now or a few instructions ago, with the sender's bit time in ns. The
  /// character before must have ended. It is lost while the chip or its receiver is off.
  void begin_serial_input(BusTime start, const SerialCharacter& character, BusTime bit);
  /// Called with each byte that USART2 sends, and the true time at which its stop bit ends, in addition to
  /// BoardSignals::serial_output().
  using SerialWatch = std::function<void(BusTime time, std::uint8_t byte)>;
  void set_serial_watch(SerialWatch watch);

  /// Length of the pulses at an output of TIM2 (1 to 4) that reaches its pin (Timer::high_time()); nothing without
  /// pulses.
  [[nodiscard]] std::optional<LocalTime> pulse_time(unsigned channel) const;
  /// Called when the level of a pin changes, with the true time of its edge. The pin is a plain input or output, or an
  /// output of TIM2; a pin that another peripheral drives counts as low. One pin can be watched; the watch must be set
  /// before the chip is switched on.
  using PinWatch = std::function<void(BusTime time, bool high)>;
  void set_pin_watch(char port, unsigned number, PinWatch watch);
  /// Called when the program writes CCR1 of TIM2, with the true time at which the instruction begins.
  using CompareWatch = std::function<void(BusTime time, std::uint32_t counts)>;
  void set_compare_watch(CompareWatch watch);

  /// Index of the chip's controller on the bus.
  [[nodiscard]] std::size_t controller() const;
  /// Number of instructions executed since the chip was made.
  [[nodiscard]] std::uint64_t instructions() const;
  /// Number of starts of the CPU since the chip was made: after power on, and after each reset.
  [[nodiscard]] std::uint64_t starts() const;

  /// Called when the program requests to send a frame, with the instructions executed so far.
  using TransmitWatch = std::function<void(std::uint16_t identifier, std::uint64_t instructions)>;
  void set_transmit_watch(TransmitWatch watch);

  /// Called when the program has begun a flash operation: it erases the sector at the address, or programs a word
  /// there.
  using FlashWatch = std::function<void(std::uint32_t address, bool erase)>;
  void set_flash_watch(FlashWatch watch);

  enum class DebugEvent : std::uint8_t {
    about_to_run,
    breakpoint,
    step,   ///< the single instruction is done
    fault,  ///< fault, lock-up, or use of what is not modelled
  };
  /// Debugger's function, called between instructions. It returns true to run one instruction, followed by `step`. It
  /// may throw.
  using DebugHook = std::function<bool(DebugEvent)>;
  void set_debug_hook(DebugHook hook);
  [[nodiscard]] bool has_debug_hook() const;
  [[nodiscard]] Cpu& cpu();

  /// Takes the oldest event.
  [[nodiscard]] std::optional<ChipEvent> take_event();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::sim
