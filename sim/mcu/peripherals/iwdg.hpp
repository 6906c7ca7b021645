#pragma once

// Independent watchdog IWDG (RM0090, section 21). It counts cycles of LSI, also during sleep.

#include <cstdint>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Iwdg final : public RegisterBlock {
 public:
  /// lsi_hz: frequency of the chip's LSI, 17,000 to 47,000 (DS8626, LSI oscillator characteristics); throws
  /// std::invalid_argument for another one.
  explicit Iwdg(ChipServices& chip, std::uint32_t lsi_hz = 32'000);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  /// Stops the watchdog and LSI: a reset resets the whole chip.
  void reset() override;
  /// Time at which the watchdog resets the chip, unless the program reloads it before.
  [[nodiscard]] LocalTime next_event() const override;
  void advance() override;

  /// Whether the watchdog has been started: only a reset stops it, and LSI runs with it.
  [[nodiscard]] bool is_running() const { return running_; }
  /// Switches LSI for another reason (RCC_CSR.LSION). Without LSI an update of PR or RLR does not end.
  void lsi_switched(bool on);
  /// Duration of LSI cycles in local time, rounded up.
  [[nodiscard]] LocalTime lsi_cycles(std::uint64_t count) const;

 private:
  void settle();
  void write_key(std::uint32_t value);
  void start_count(LocalTime now, std::uint32_t count);
  [[nodiscard]] LocalTime timeout() const;
  [[nodiscard]] bool lsi_runs() const { return running_ || lsi_on_; }
  void schedule_updates();

  /// A register value on its way into the clock domain of LSI.
  struct Update {
    bool pending = false;
    std::uint32_t value = 0;
    LocalTime done = never_on_chip;
  };

  std::uint32_t lsi_hz_;
  bool running_ = false;
  bool lsi_on_ = false;
  bool unlocked_ = false;
  bool expired_ = false;
  std::uint32_t prescaler_ = 0;   ///< PR
  std::uint32_t reload_ = 0xFFF;  ///< RLR
  Update prescaler_update_;
  Update reload_update_;
  LocalTime since_ = 0;      ///< when `count_` began
  std::uint32_t count_ = 0;  ///< value of the down counter at `since_`
};

}  // namespace proleg::sim
