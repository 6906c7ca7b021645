#include "firmware/module/servo_monitor.hpp"

#include <algorithm>

namespace proleg::firmware {

void ServoMonitor::reset(const BoardRecord& board) {
  port_.calibrate(board);
  measures_angle_ = board.has_feedback;
  limit_ma_ = board.current_limit_ma;
  limit_time_ms_ = board.current_limit_time_ms;
  readings_ = {};
  stale_readings_ = 0;
  is_too_hot_ = false;
  clear_over_current();
  next_reading_ = never;
}

void ServoMonitor::read(Microseconds now, std::uint32_t tick_period_us) {
  constexpr std::uint16_t max_current_ma = 0x7FFF;  // greatest value of object 0x6078
  readings_ = port_.take_readings();
  readings_.current_ma = measures_current_ ? std::min(readings_.current_ma, max_current_ma) : std::uint16_t{0};
  if (!measures_angle_) {
    readings_.angle.reset();
  }
  if (readings_.are_new) {
    stale_readings_ = 0;
    is_too_hot_ = readings_.temperature_c >= (is_too_hot_ ? cool_temperature_c : max_temperature_c);
    if (measures_current_) {
      judge_current(now);
    }
  } else if (!sensors_failed()) {
    ++stale_readings_;
  }
  next_reading_ = now + tick_period_us + tick_period_us / 2;
}

void ServoMonitor::judge_current(Microseconds now) {
  excess_ma_ += readings_.current_ma - limit_ma_;
  if (limit_ma_ == 0 || excess_ma_ <= 0) {
    clear_over_current();
    return;
  }
  if (above_since_ == never) {
    above_since_ = now;
  }
  over_current_ = now - above_since_ >= Microseconds{limit_time_ms_} * 1'000U;
}

void ServoMonitor::clear_over_current() {
  over_current_ = false;
  above_since_ = never;
  excess_ma_ = 0;
}

}  // namespace proleg::firmware
