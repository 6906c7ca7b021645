#pragma once

#include <chrono>
#include <cstdint>

namespace proleg::tools {

/// When the ticks of a simulation are due, at a multiple of real time. A simulation that is late does not catch up in a
/// burst.
class RunPace {
 public:
  using Clock = std::chrono::steady_clock;
  /// More is a delay.
  static constexpr std::chrono::milliseconds tolerance{50};

  explicit RunPace(std::uint32_t tick_us) : tick_us_(tick_us) {}

  /// factor: simulated time by real time; 0: as fast as it goes.
  void set_factor(double factor, Clock::time_point now) {
    factor_ = factor;
    due_ = now;
  }
  [[nodiscard]] double factor() const { return factor_; }

  /// The run begins, or goes on after a pause.
  void begin(Clock::time_point now) {
    due_ = now;
    measured_from_ = now;
    ticks_ = 0;
  }
  /// When the next tick is due.
  [[nodiscard]] Clock::time_point due() const { return due_; }
  /// A tick was simulated.
  void tick_done(Clock::time_point now) {
    ++ticks_;
    if (factor_ > 0.0) {
      due_ +=
          std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::micro>(tick_us_ / factor_));
    }
    if (factor_ <= 0.0 || now > due_ + tolerance) {
      due_ = now;
    }
  }

  /// Simulated time by real time, since the last call or since begin().
  [[nodiscard]] double measure(Clock::time_point now) {
    const double seconds = std::chrono::duration<double>(now - measured_from_).count();
    const double factor = seconds > 0.0 ? static_cast<double>(ticks_) * tick_us_ * 1e-6 / seconds : 0.0;
    measured_from_ = now;
    ticks_ = 0;
    return factor;
  }

 private:
  std::uint32_t tick_us_;
  double factor_ = 1.0;
  Clock::time_point due_{};
  Clock::time_point measured_from_{};
  std::uint64_t ticks_ = 0;
};

}  // namespace proleg::tools
