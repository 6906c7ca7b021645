#pragma once

#include <cstdint>

#include "sim/bus/controller.hpp"
#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {

/// The crystal of a chip converts between local and true time, from the moment the chip was switched on, in integers.
class Oscillator {
 public:
  /// parts_per_billion: by how much local time runs faster than true time; within +-1,000,000.
  explicit Oscillator(std::int32_t parts_per_billion)
      : rate_(std::uint64_t{local_time_per_us} * static_cast<std::uint64_t>(billion + parts_per_billion)) {}

  void start(BusTime origin) { origin_ = origin; }

  /// Local time at a true time; 0 before the start.
  [[nodiscard]] LocalTime at(BusTime time) const {
    return time <= origin_ ? 0 : static_cast<LocalTime>(Wide{time - origin_} * rate_ / ns_per_rate);
  }
  /// The earliest true time at which local time is this or more; never_on_bus for never_on_chip.
  [[nodiscard]] BusTime when(LocalTime time) const {
    return time == never_on_chip ? never_on_bus
                                 : origin_ + static_cast<BusTime>((Wide{time} * ns_per_rate + rate_ - 1) / rate_);
  }

 private:
  __extension__ using Wide = unsigned __int128;
  static constexpr std::int64_t billion = 1'000'000'000;
  /// Number of nanoseconds in which local time passes by rate_.
  static constexpr std::uint64_t ns_per_rate = 1'000'000'000'000;

  std::uint64_t rate_;
  BusTime origin_ = 0;
};

}  // namespace proleg::sim
