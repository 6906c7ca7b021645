#pragma once

// The SysTick timer (ARMv7-M Architecture Reference Manual, DDI 0403, B3.3), computed from local time on access.

#include <cstdint>

#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {

class SystemTick {
 public:
  void reset();

  // Registers, at local time `now`, with core clock of period `core`.
  [[nodiscard]] std::uint32_t read_control(LocalTime now);
  void write_control(std::uint32_t value, LocalTime now, LocalTime core);
  [[nodiscard]] std::uint32_t reload() const { return reload_; }
  void write_reload(std::uint32_t value, LocalTime now);
  [[nodiscard]] std::uint32_t read_value(LocalTime now);
  /// Clears the counter; the written value has no effect.
  void write_value(LocalTime now);

  /// When the counter reaches 0 next and pends the exception; never_on_chip if it does not.
  [[nodiscard]] LocalTime next_exception() const;
  /// Counts up to `now`.
  void advance(LocalTime now);
  /// The core clock has another period from `now` on.
  void set_core_period(LocalTime now, LocalTime core);
  /// Whether the exception was pended since the last call.
  [[nodiscard]] bool take_exception();

 private:
  [[nodiscard]] bool is_enabled() const { return (control_ & 1U) != 0; }
  /// Of the counter, when it has advanced to `now`.
  [[nodiscard]] LocalTime value_at(LocalTime now) const;

  std::uint32_t control_ = 0;  ///< ENABLE, TICKINT, CLKSOURCE
  bool count_flag_ = false;
  bool exception_ = false;
  std::uint32_t reload_ = 0;
  LocalTime core_ = 1;
  LocalTime period_ = 1;         ///< of a count
  LocalTime next_zero_ = 0;      ///< when the counter reaches 0, while it is enabled
  LocalTime loads_at_ = 0;       ///< when it leaves 0
  LocalTime stopped_value_ = 0;  ///< while it is disabled
};

}  // namespace proleg::sim
