#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "host/robot_control/gait_driver.hpp"

namespace proleg::host {

/// Port: the clock of a drive.
class Clock {
 public:
  virtual ~Clock() = default;
  /// The time in microseconds; never decreases.
  [[nodiscard]] virtual std::uint64_t now_us() = 0;
  virtual void sleep_until(std::uint64_t time_us) = 0;
};

/// The computer's clock.
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] std::uint64_t now_us() override;
  void sleep_until(std::uint64_t time_us) override;
};

struct DriveResult {
  std::uint32_t gait_ticks = 0;
  std::uint32_t late_ticks = 0;        ///< ticks that began more than a tick period late; the ticks behind them moved
  std::uint64_t max_delay_us = 0;      ///< greatest delay of the start of a tick
  double max_difference_deg = 0.0;     ///< GaitDriver::max_difference_deg()
  std::optional<std::string> failure;  ///< one line about the failure that ended the run early
};

/// Starts the driver and calls its tick() in time until it has finished. must_stop: asked before each tick; true begins
/// the ramp down. A tick that begins late does not make the next ones faster. Throws RobotControlError if the driver
/// does not start.
[[nodiscard]] DriveResult drive(GaitDriver& driver, Clock& clock, const std::function<bool()>& must_stop);

}  // namespace proleg::host
