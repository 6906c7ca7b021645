#pragma once

#include <algorithm>
#include <cstdint>

namespace proleg::sim {

/// Microseconds from the start of a servo's interval to the moment when the loop reads its pulse from the module: half
/// of the interval, or half a millisecond if that is less. By then the module has given this pulse and not yet the
/// next.
constexpr std::uint32_t pulse_reading_delay_us(std::uint32_t servo_period_us) {
  constexpr std::uint32_t max_delay_us = 500;
  return std::min(servo_period_us / 2, max_delay_us);
}

/// When a simulated servo begins to act on a pulse: microseconds after SYNC 0.
///
/// It acts at the start of the interval. At the end of a tick it acts at the next SYNC instead, if a pulse could be
/// read only after that SYNC. With modules in the loop the world has made the steps of the tick by then, since the
/// modules take their touch sensors at the SYNC. `proleg simulate` follows the same rule and so simulates the same
/// world. Steps of 1 ms and more do not need the rule: no step of the tick starts that late.
///
/// next_sync_us: of the SYNC after the start of the interval.
constexpr std::uint64_t acting_time_before_sync_us(std::uint64_t start_us, std::uint32_t servo_period_us,
                                                   std::uint64_t next_sync_us) {
  // A SYNC may come late, and the next one in time: it waits for a frame on the wire or is sent again after an error.
  constexpr std::uint32_t max_sync_delay_us = 500;
  const bool is_late = start_us + pulse_reading_delay_us(servo_period_us) + max_sync_delay_us > next_sync_us;
  return is_late ? next_sync_us : start_us;
}
constexpr std::uint64_t acting_time_us(std::uint64_t start_us, std::uint32_t servo_period_us,
                                       std::uint32_t tick_period_us) {
  const std::uint64_t next_sync_us = (start_us / tick_period_us + 1) * tick_period_us;
  return acting_time_before_sync_us(start_us, servo_period_us, next_sync_us);
}

}  // namespace proleg::sim
