#include "host/robot_control/drive_loop.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

namespace proleg::host {

std::uint64_t SteadyClock::now_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

void SteadyClock::sleep_until(std::uint64_t time_us) {
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point(std::chrono::microseconds(time_us)));
}

DriveResult drive(GaitDriver& driver, Clock& clock, const std::function<bool()>& must_stop) {
  driver.start();
  DriveResult result;
  std::uint64_t next_us = clock.now_us();
  while (driver.phase() != GaitDriver::Phase::finished) {
    clock.sleep_until(next_us);
    const std::uint64_t now_us = clock.now_us();
    const std::uint64_t delay_us = now_us > next_us ? now_us - next_us : 0;
    result.max_delay_us = std::max(result.max_delay_us, delay_us);
    if (delay_us > driver.tick_us()) {
      ++result.late_ticks;
      next_us = now_us;  // late ticks are not made up for: the joints would move too fast
    }
    if (must_stop && must_stop()) {
      driver.stop();
    }
    static_cast<void>(driver.tick());
    next_us += driver.tick_us();
  }
  result.gait_ticks = driver.gait_ticks();
  result.max_difference_deg = driver.max_difference_deg();
  result.failure = driver.failure();
  return result;
}

}  // namespace proleg::host
