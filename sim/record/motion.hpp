#pragma once

// The motion of a simulated world: the poses of what moves in it after every tick. Hash and comparison of motion are
// here for all who need them.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "shared/computer/hash/sha256.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// SHA-256 over the poses of all links from the head, then of all objects that move, tick by tick: of each pose
/// position and quaternion (w, x, y, z), eight bytes a number, little-endian, -0.0 as 0.0. The velocities need no
/// bytes: poses of consecutive ticks differ if they do. Equal for equal runs of the same program on the same processor;
/// another compiler or processor may round otherwise.
class MotionHash {
 public:
  void append(std::span<const Pose> links, std::span<const Pose> objects);
  /// Hash of all ticks so far, 64 lower-case hexadecimal digits. More ticks may follow.
  [[nodiscard]] std::string hex() const { return hash_.hex(); }

 private:
  ValueHash hash_;
};

/// The hash of a recorded motion until the end of a tick.
struct RecordedMotionHash {
  std::uint32_t tick = 0;
  std::string hash;
};

/// Whether a second of the run ends with this tick: then a recording holds the hash of its motion until then.
[[nodiscard]] constexpr bool ends_second(std::uint32_t tick, std::uint32_t tick_period_us) {
  constexpr std::uint64_t second_us = 1'000'000;
  const std::uint64_t start_us = std::uint64_t{tick} * tick_period_us;
  return start_us / second_us != (start_us + tick_period_us) / second_us;
}

/// What is elsewhere first in a tick: a link, or an object that moves. From 0.
struct MotionDifference {
  std::uint32_t tick = 0;
  bool is_object = false;
  std::size_t part = 0;
};

/// The first link, or else the first object, whose two poses differ in any bit; nothing if all are equal. Both sides
/// must have as many links; objects that only one side has are left out.
[[nodiscard]] std::optional<MotionDifference> compare_motion(std::uint32_t tick, std::span<const Pose> found_links,
                                                             std::span<const Pose> expected_links,
                                                             std::span<const Pose> found_objects,
                                                             std::span<const Pose> expected_objects);

}  // namespace proleg::sim
