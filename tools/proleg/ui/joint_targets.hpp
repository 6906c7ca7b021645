#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Where joints with direct positions are sent: each goes from where it is to its goal, at limited speed. Angles: 90
/// degrees = 2^30.
class JointTargets {
 public:
  /// limits: of each joint. tick_us: microseconds from one step to the next.
  JointTargets(std::span<const AngleLimits> limits, std::uint32_t tick_us);

  /// The joint is here, and stays.
  void place(unsigned joint, std::int32_t position);
  /// The joint goes there, or to its limit, with this speed in degrees a second, above 0.
  void go_to(unsigned joint, std::int32_t goal, double speed);
  /// All joints stay where they are.
  void halt();
  /// One tick on.
  void advance();

  [[nodiscard]] std::span<const std::int32_t> positions() const { return positions_; }
  /// Joints whose positions have changed since they were taken, at most this many. Every joint gets its turn.
  [[nodiscard]] std::vector<unsigned> take_moved(std::size_t at_most);

 private:
  struct Joint {
    std::int32_t lower;
    std::int32_t upper;
    std::int32_t goal = 0;
    std::int64_t step = 0;  ///< of a tick
    bool has_moved = false;
  };

  std::vector<Joint> joints_;
  std::vector<std::int32_t> positions_;
  std::uint32_t tick_us_;
  std::size_t turn_ = 0;  ///< the joint that take_moved() looks at first
};

}  // namespace proleg::tools
