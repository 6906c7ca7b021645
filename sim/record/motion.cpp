#include "sim/record/motion.hpp"

#include <algorithm>
#include <bit>

namespace proleg::sim {
namespace {

bool is_same(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

/// The first place at which two lists differ; nothing if one is the beginning of the other.
std::optional<std::size_t> first_difference(std::span<const Pose> found, std::span<const Pose> expected) {
  const std::size_t both = std::min(found.size(), expected.size());
  const auto other = std::ranges::mismatch(found.first(both), expected.first(both), is_same).in1;
  const auto place = static_cast<std::size_t>(other - found.begin());
  return place < both ? std::optional(place) : std::nullopt;
}

}  // namespace

void MotionHash::append(std::span<const Pose> links, std::span<const Pose> objects) {
  for (const std::span<const Pose> poses : {links, objects}) {
    for (const Pose& pose : poses) {
      const Eigen::Vector3d& position = pose.position;
      const Eigen::Quaterniond& turn = pose.orientation;
      for (const double number : {position.x(), position.y(), position.z(), turn.w(), turn.x(), turn.y(), turn.z()}) {
        hash_.append_number(number + 0.0);  // a database does not keep -0.0
      }
    }
  }
}

std::optional<MotionDifference> compare_motion(std::uint32_t tick, std::span<const Pose> found_links,
                                               std::span<const Pose> expected_links,
                                               std::span<const Pose> found_objects,
                                               std::span<const Pose> expected_objects) {
  if (const auto link = first_difference(found_links, expected_links)) {
    return MotionDifference{tick, false, *link};
  }
  if (const auto object = first_difference(found_objects, expected_objects)) {
    return MotionDifference{tick, true, *object};
  }
  return std::nullopt;
}

}  // namespace proleg::sim
