#pragma once

// Period, amplitude and lag of periodic joint angles, from the times at which they rise through a level.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "robot.hpp"

namespace proleg::test {

class WaveMeter {
 public:
  /// level: in degrees.
  explicit WaveMeter(double level = 0) : level_(level) {}

  /// Takes the angle [degrees] at the next time, one unit of time after the one before.
  void add(double angle) {
    if (time_ > 0 && before_ < level_ && angle >= level_) {
      rises_.push_back(time_ - 1 + (level_ - before_) / (angle - before_));
    }
    before_ = angle;
    ++time_;
    lowest_ = std::min(lowest_, angle);
    highest_ = std::max(highest_, angle);
  }

  [[nodiscard]] std::size_t periods() const { return rises_.empty() ? 0 : rises_.size() - 1; }
  /// Mean period, in units of time.
  [[nodiscard]] double period() const {
    return periods() == 0 ? std::numeric_limits<double>::infinity()
                          : (rises_.back() - rises_.front()) / static_cast<double>(periods());
  }
  [[nodiscard]] double lowest() const { return lowest_; }
  [[nodiscard]] double highest() const { return highest_; }

  /// Phase of this wave minus that of another wave of about the same period, in degrees: the mean over all rises.
  [[nodiscard]] double lead_over(const WaveMeter& other) const {
    double sines = 0;
    double cosines = 0;
    for (const double rise : rises_) {
      for (const double its_rise : other.rises_) {
        if (std::abs(its_rise - rise) < period()) {
          const double angle = 2 * std::numbers::pi * (its_rise - rise) / period();
          sines += std::sin(angle);
          cosines += std::cos(angle);
        }
      }
    }
    return std::atan2(sines, cosines) * 180 / std::numbers::pi;
  }

 private:
  double level_;
  double time_ = 0;
  double before_ = 0;
  double lowest_ = std::numeric_limits<double>::infinity();
  double highest_ = -std::numeric_limits<double>::infinity();
  std::vector<double> rises_;
};

/// Runs a kernel and meters the set-points of all its joints.
inline std::vector<WaveMeter> meter(Kernel& kernel, unsigned ticks, double level = 0) {
  std::vector<WaveMeter> meters(kernel.local_joint_count(), WaveMeter(level));
  for (unsigned tick = 0; tick < ticks; ++tick) {
    kernel.advance();
    for (unsigned joint = 0; joint < meters.size(); ++joint) {
      meters[joint].add(in_degrees(kernel.setpoint(joint)));
    }
  }
  return meters;
}

}  // namespace proleg::test
