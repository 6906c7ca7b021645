#pragma once

#include <bit>
#include <cstdint>

namespace proleg::canopen {

/// Joints of a robot, for book-keeping: bit j is kernel joint j. (A JointMask says whom a slot drives.)
using JointSet = std::uint64_t;

[[nodiscard]] constexpr JointSet set_of(unsigned joint) { return JointSet{1} << joint; }
[[nodiscard]] constexpr bool contains(JointSet joints, unsigned joint) { return (joints & set_of(joint)) != 0; }
/// The lowest member of a set that is not empty.
[[nodiscard]] constexpr unsigned first_of(JointSet joints) { return static_cast<unsigned>(std::countr_zero(joints)); }
/// Joints 0 to count - 1; count is 1 to 64.
[[nodiscard]] constexpr JointSet all_of(unsigned count) { return ~JointSet{0} >> (64U - count); }

}  // namespace proleg::canopen
