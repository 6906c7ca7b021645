#pragma once

#include <chrono>
#include <cstdint>

namespace proleg::tools {

/// The time that a simulation has to reach, so that it keeps the pace of real time. A simulation that is late, because
/// the computer is too slow or was suspended, catches up by at most 50 ms: for the rest of the delay its clock stops.
class RealTimePace {
 public:
  /// Largest lateness that the simulation catches up; more is a delay.
  static constexpr std::uint64_t tolerance_ns = 50'000'000;

  /// Time since the start, without the delays.
  [[nodiscard]] std::uint64_t now_ns() const { return since_start_ns() - delayed_ns_; }

  /// Notes the time that the simulation has reached.
  void simulated_to(std::uint64_t time_ns) {
    if (const std::uint64_t now = now_ns(); now > time_ns + tolerance_ns) {
      delayed_ns_ += now - time_ns;
      ++delays_;
    }
  }
  [[nodiscard]] std::uint64_t delays() const { return delays_; }
  [[nodiscard]] std::uint64_t delayed_ns() const { return delayed_ns_; }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::uint64_t since_start_ns() const {
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start_).count());
  }

  Clock::time_point start_ = Clock::now();
  std::uint64_t delayed_ns_ = 0;
  std::uint64_t delays_ = 0;
};

}  // namespace proleg::tools
