#include "host/dynamixel/standstill.hpp"

#include <algorithm>
#include <cstdlib>

namespace proleg::host {
namespace {

/// 5 degrees: more than the error that a load causes in a servo that follows.
constexpr std::int64_t min_difference = 57;
/// 1.5 degrees: more than the noise of a servo that stands still.
constexpr std::int64_t max_noise = 17;

/// The positions may be any numbers that a servo reports.
std::int64_t distance(std::int32_t a, std::int32_t b) { return std::abs(std::int64_t{a} - b); }

}  // namespace

std::optional<Standstill::Report> Standstill::add(std::int32_t position, std::int32_t goal, std::uint64_t now_us) {
  const std::int64_t difference = distance(goal, position);
  if (!rest_position_ || distance(position, *rest_position_) > max_noise) {
    reset();
    rest_position_ = position;
  } else if (difference > min_difference) {
    time_us_ += now_us - last_us_;
    max_difference_ = std::max(max_difference_, difference);
  }
  last_us_ = now_us;
  if (time_us_ < next_report_us_) {
    return std::nullopt;
  }
  next_report_us_ *= 2;
  return Report{time_us_, max_difference_};
}

}  // namespace proleg::host
