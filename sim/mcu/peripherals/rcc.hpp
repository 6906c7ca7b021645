#pragma once

// Reset and clock control RCC (RM0090, section 7). It rejects a setting that the manual forbids, with its figures,
// and one whose core clock does not divide 1,008 MHz, in which local time counts.

#include <cstdint>

#include "sim/mcu/peripherals/clock_tree.hpp"
#include "sim/mcu/peripherals/flash_interface.hpp"
#include "sim/mcu/peripherals/iwdg.hpp"
#include "sim/mcu/peripherals/peripheral_gates.hpp"
#include "sim/mcu/peripherals/pwr.hpp"
#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Rcc final : public RegisterBlock {
 public:
  // Times until an oscillator is ready, for the crystal of the board, and for HSI, LSI and PLL (DS8626; PLL: 75 to 300
  // us).
  static constexpr LocalTime hse_start = 2'000 * local_time_per_us;
  static constexpr LocalTime hsi_start = 2 * local_time_per_us;
  static constexpr LocalTime pll_start = 200 * local_time_per_us;
  static constexpr LocalTime lsi_start = 40 * local_time_per_us;
  /// From the failure of the crystal to the reaction of the clock security system. The manual gives no figure: this is
  /// 80 periods of the crystal.
  static constexpr LocalTime failure_detection = 10 * local_time_per_us;

  /// flash and power limit the core clock; iwdg keeps LSI on while it runs.
  /// crystal: its frequency in Hz.
  Rcc(ChipServices& chip, FlashInterface& flash, Pwr& power, Iwdg& iwdg, std::uint32_t crystal = hse_hz);

  /// Adds a peripheral whose clock and reset are switched here, or that counts clocks; known by its base(). It must
  /// outlive RCC.
  void attach(Peripheral& peripheral) { gates_.attach(peripheral); }

  // Parts that fail, or work again, at ChipServices::now(); the state lasts over a reset. While the system clock has
  // no source, the core stands still, and only LSI counts. The manual does not say which frequency a PLL without its
  // input has; here it has none.
  void set_crystal(bool runs);
  /// Sets whether the PLL can lock. One that is in use and loses its lock runs on: here with three quarters of its
  /// frequency, without PLLRDY. No interrupt comes (7.2.7: the clock security system watches HSE only).
  void set_pll(bool locks);
  [[nodiscard]] bool core_stands_still() const { return stands_still_; }

  /// The present clocks, for ChipServices::clocks().
  [[nodiscard]] const Clocks& clocks() const { return clocks_; }
  /// Whether a peripheral's registers answer. Those of RCC, FLASH and IWDG always answer.
  [[nodiscard]] bool is_clocked(const Peripheral& peripheral) const { return gates_.is_clocked(peripheral); }
  /// Rejects an access to a peripheral without clock, or one that is held in reset:
  /// "USART2_BRR: its clock is off (RCC_APB1ENR bit 17)".
  void require_clock(const Peripheral& peripheral, std::uint32_t offset) const;

  /// Notes in RCC_CSR why the chip starts; to be called with every reset(). Each internal cause pulls NRST as well
  /// (RM0090, 7.1.1), so that PINRSTF is always set.
  void note_start(ResetCause cause);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  /// Resets all registers except the flags of note_start(). The chip resets the attached peripherals.
  void reset() override;
  /// Time at which a selected clock becomes ready and takes over, or the clock security system reacts (7.2.7).
  [[nodiscard]] LocalTime next_event() const override;
  void advance() override;
  [[nodiscard]] bool is_idle() const override { return false; }

 private:
  struct Oscillator {
    bool on = false;
    LocalTime ready_at = never_on_chip;
    LocalTime not_ready_at = 0;  ///< time from which the clock that was switched off is not ready

    void switch_to(bool wanted, LocalTime now, LocalTime start, LocalTime stop);
    [[nodiscard]] bool ready(LocalTime now) const { return on ? now >= ready_at : now < not_ready_at; }
  };

  void start_registers(LocalTime now);
  /// Whether an oscillator that is on can run: its crystal and its input work.
  [[nodiscard]] bool works(ClockSource source) const;
  /// Whether it runs, if with a wrong frequency.
  [[nodiscard]] bool oscillates(ClockSource source) const;
  [[nodiscard]] Clocks present_clocks() const;
  void oscillator_failed_or_works();
  void watch_crystal();
  void react_to_failure();
  void set_clocks(const Clocks& next, bool stands_still);
  void settle();
  void write_cr(std::uint32_t value);
  void write_pllcfgr(std::uint32_t value);
  void write_cfgr(std::uint32_t value);
  void write_csr(std::uint32_t value);
  [[nodiscard]] const Oscillator& oscillator(ClockSource source) const;
  /// Computes the clocks. Rejects a setting that the manual forbids, and names the write to CFGR that caused it.
  [[nodiscard]] Clocks clocks_of(ClockSource source, std::uint32_t setting, std::uint32_t value) const;
  void change_clocks(const Clocks& next);
  [[nodiscard]] bool lsi_ready() const;

  FlashInterface* flash_;
  Pwr* power_;
  Iwdg* iwdg_;
  std::uint32_t crystal_;
  PeripheralGates gates_;
  Clocks clocks_;

  Oscillator hsi_;
  Oscillator hse_;
  Oscillator pll_;
  Oscillator lsi_;
  std::uint32_t hsi_trim_ = 0x10;
  std::uint32_t pllcfgr_ = 0;
  std::uint32_t cfgr_ = 0;  ///< without SWS
  ClockSource current_ = ClockSource::hsi;
  std::uint32_t reset_flags_ = 0;

  bool crystal_runs_ = true;
  bool pll_locks_ = true;
  bool stands_still_ = false;
  bool is_secured_ = false;                    ///< CSSON
  bool has_reported_ = false;                  ///< CSSF
  LocalTime failure_seen_at_ = never_on_chip;  ///< time of the reaction to a failure of the crystal
};

}  // namespace proleg::sim
