#pragma once

// General-purpose timers TIM2, TIM3 and TIM5 (RM0090, section 18): an up-counter of 32 bits (TIM3: 16) with four
// outputs. It computes its state on access, from the time that has passed since the access before.

#include <array>
#include <cstdint>
#include <optional>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

/// A peripheral that the trigger output of a timer starts.
class TriggerInput {
 public:
  /// Receives a trigger. time: its time, ChipServices::now() or earlier. Triggers come in the order of their times.
  virtual void trigger(LocalTime time) = 0;
  /// Whether the next triggers start something that is no visible event (Peripheral::next_visible_event).
  [[nodiscard]] virtual bool works_unseen() const = 0;

 protected:
  ~TriggerInput() = default;
};

class Timer final : public RegisterBlock {
 public:
  static constexpr unsigned channel_count = 4;
  static constexpr std::uint32_t ccr1 = 0x34;  ///< offset of the compare register of channel 1

  /// number: 2, 3 or 5; throws std::invalid_argument for another one.
  Timer(ChipServices& chip, unsigned number);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] LocalTime next_event() const override;
  [[nodiscard]] LocalTime next_visible_event() const override;
  void advance() override;
  void clocks_change(const Clocks& next) override;
  [[nodiscard]] bool is_idle() const override { return !enabled(); }

  /// Sets the receiver of the trigger output (TRGO), which CR2.MMS = 2 makes of an update. Without it MMS is rejected.
  void connect_trigger_output(TriggerInput& input) { trigger_input_ = &input; }

  // Outputs of a channel, 1 to 4.

  /// Counts for which its PWM output is active in each period, as the program wrote them last (with preload: they hold
  /// from the next update on). Nothing unless the counter runs, the channel is in a PWM mode and its output is enabled.
  [[nodiscard]] std::optional<std::uint32_t> pulse_width(unsigned channel) const;
  /// Time for which the output is high in each period, at ChipServices::now(): in the period that runs; or, if the
  /// program wrote another width while the output was active, or in a period without a pulse, in the next one. Empty if
  /// pulse_width() is empty.
  [[nodiscard]] std::optional<LocalTime> high_time(unsigned channel);
  struct Output {
    bool driven = false;  ///< CCxE
    bool high = false;    ///< low if it is not driven
    friend bool operator==(const Output&, const Output&) = default;
  };
  /// Output at ChipServices::now().
  [[nodiscard]] Output output(unsigned channel);
  /// Time after ChipServices::now() at which the level of the output changes next if no register is written before; or
  /// an earlier time, at which the caller must ask again (an update loads preloaded registers). never_on_chip if the
  /// level stays.
  [[nodiscard]] LocalTime next_edge(unsigned channel);

  /// Duration of a count in local time: (PSC + 1) clocks of the timer, with the prescaler that is in effect.
  [[nodiscard]] LocalTime count_period() const { return clock() * (LocalTime{prescaler_} + 1); }
  /// Counts in a period: ARR + 1, as the program wrote it last.
  [[nodiscard]] std::uint64_t period() const { return std::uint64_t{arr_preload_} + 1; }

 private:
  struct Channel {
    std::uint32_t preload = 0;
    std::uint32_t compare = 0;   ///< the value that is in effect
    bool frozen_active = false;  ///< OCxREF in frozen mode
    /// `preload` was written while the output was active, or in a period without a pulse: the next period has it.
    bool asked_in_time = true;
  };

  /// Period of the timer's clock.
  [[nodiscard]] LocalTime clock() const { return chip().clocks().apb1_timers; }
  [[nodiscard]] bool enabled() const { return (cr1_ & 1U) != 0; }
  [[nodiscard]] unsigned output_mode(unsigned channel) const;
  [[nodiscard]] bool preloads(unsigned channel) const;
  [[nodiscard]] bool reference(unsigned channel) const;
  [[nodiscard]] bool counts() const { return enabled() && arr_ != 0; }
  [[nodiscard]] LocalTime time_of(std::uint64_t counts) const;
  [[nodiscard]] LocalTime overflow_time() const;
  [[nodiscard]] LocalTime prescaler_progress() const;
  [[nodiscard]] std::optional<LocalTime> match_time(unsigned channel) const;

  [[nodiscard]] bool triggers() const;
  [[nodiscard]] LocalTime next_event(bool counts_triggers) const;
  void settle();
  void match(std::uint32_t after, std::uint32_t upto);
  void overflow();
  void update(LocalTime time, bool overflowed);
  void write_cr1(std::uint32_t value);
  void write_egr(std::uint32_t value);
  void write_ccmr(unsigned index, std::uint32_t offset, std::uint32_t value);
  void write_ccer(std::uint32_t value);
  void set_arr(std::uint32_t value);
  void update_interrupt();

  InterruptLine interrupt_;
  std::uint32_t max_count_;
  TriggerInput* trigger_input_ = nullptr;
  std::uint32_t cr1_ = 0;
  std::uint32_t cr2_ = 0;
  std::uint32_t dier_ = 0;
  std::uint32_t sr_ = 0;
  std::array<std::uint32_t, 2> ccmr_{};
  std::uint32_t ccer_ = 0;
  std::uint32_t prescaler_preload_ = 0;
  std::uint32_t prescaler_ = 0;
  std::uint32_t arr_preload_ = 0;
  std::uint32_t arr_ = 0;
  std::array<Channel, channel_count> channels_;

  // While it is enabled, the counter had `count_` at `since_`, and has one more after each further count_period().
  // `since_` is signed: a change of clocks can put it before power-on.
  std::uint32_t count_ = 0;
  std::int64_t since_ = 0;
  LocalTime counting_from_ = 0;  ///< one clock after CEN (RM0090, 18.3.1)
  LocalTime phase_ = 0;          ///< progress of the prescaler when it was enabled or disabled
};

}  // namespace proleg::sim
