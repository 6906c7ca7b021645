#pragma once

#include <cstdint>
#include <optional>

namespace proleg::host {

/// Finds out whether a servo that has torque stands still away from its goal: it is blocked, or its gear is broken. A
/// servo that is only slow, or waits at its goal, does not stand still in this sense.
class Standstill {
 public:
  struct Report {
    std::uint64_t time_us;        ///< for which it has stood still away from its goal
    std::int64_t max_difference;  ///< steps, in this time
  };

  /// Adds a position that was read, and the goal at that time, both in steps. Returns a report after 1, 2, 4, ... s of
  /// one standstill.
  std::optional<Report> add(std::int32_t position, std::int32_t goal, std::uint64_t now_us);
  /// Forgets what was added: the servo was not watched for a time.
  void reset() { *this = {}; }

 private:
  static constexpr std::uint64_t first_report_us = 1'000'000;

  std::optional<std::int32_t> rest_position_;
  std::uint64_t last_us_ = 0;
  std::uint64_t time_us_ = 0;
  std::uint64_t next_report_us_ = first_report_us;
  std::int64_t max_difference_ = 0;
};

}  // namespace proleg::host
