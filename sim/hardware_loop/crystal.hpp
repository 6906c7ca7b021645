#pragma once

#include <cstdint>

#include "shared/can/can_port.hpp"
#include "sim/bus/controller.hpp"

namespace proleg::sim {

/// The clock of a node: runs a little fast or slow against true time. Integers only, so that a run repeats.
class Crystal {
 public:
  /// parts_per_billion: how much faster than true time; within +-1,000,000.
  explicit Crystal(std::int32_t parts_per_billion = 0) : error_(parts_per_billion) {}

  /// The reading of the clock at a time, in whole microseconds.
  [[nodiscard]] Microseconds at(BusTime time) const {
    const auto true_us = static_cast<std::int64_t>(time / 1000);
    return static_cast<Microseconds>(true_us + floor_divide(true_us * error_, billion));
  }

  /// The earliest time at which the clock shows this or more; never_on_bus for `never`.
  [[nodiscard]] BusTime when(Microseconds shown) const {
    if (shown == never) {
      return never_on_bus;
    }
    const auto wanted = static_cast<std::int64_t>(shown);
    std::int64_t true_us = wanted - floor_divide(wanted * error_, billion + error_) - 2;
    true_us = true_us < 0 ? 0 : true_us;
    while (at(static_cast<BusTime>(true_us) * 1000) < shown) {
      ++true_us;
    }
    return static_cast<BusTime>(true_us) * 1000;
  }

  [[nodiscard]] std::int32_t parts_per_billion() const { return error_; }

 private:
  static constexpr std::int64_t billion = 1'000'000'000;

  static std::int64_t floor_divide(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

  std::int32_t error_;
};

}  // namespace proleg::sim
