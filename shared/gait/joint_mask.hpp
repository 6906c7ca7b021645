#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace proleg {

/// Most joints of one robot; bounded by the receive objects 0x1410 + j of the protocol.
inline constexpr unsigned max_joints = 64;

/// A group of joints: bit j stands for kernel joint j, which is the j-th from the head.
class JointMask {
 public:
  constexpr JointMask() = default;
  explicit constexpr JointMask(std::uint64_t bits)
      : words_{static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32U)} {}

  /// The joints 0 to count - 1. count is at most 64.
  [[nodiscard]] static constexpr JointMask first(unsigned count) {
    return JointMask(count >= max_joints ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1);
  }

  [[nodiscard]] constexpr bool contains(unsigned joint) const {
    return joint < max_joints && ((words_[joint / 32] >> (joint % 32)) & 1U) != 0;
  }
  constexpr void insert(unsigned joint) { words_[joint / 32] |= 1U << (joint % 32); }
  [[nodiscard]] constexpr std::uint64_t bits() const { return std::uint64_t{words_[1]} << 32U | words_[0]; }

  /// The nearest member towards the head, or -1.
  [[nodiscard]] constexpr int before(unsigned joint) const {
    const std::uint64_t ahead = bits() & first(joint).bits();
    return ahead == 0 ? -1 : 63 - std::countl_zero(ahead);
  }

  /// The nearest member towards the tail, or -1.
  [[nodiscard]] constexpr int after(unsigned joint) const { return from(joint + 1); }

  /// The joint itself if it is a member, else the nearest member towards the tail, or -1.
  [[nodiscard]] constexpr int from(unsigned joint) const {
    const std::uint64_t rest = bits() & ~first(joint).bits();
    return rest == 0 ? -1 : std::countr_zero(rest);
  }

  friend constexpr bool operator==(JointMask, JointMask) = default;

 private:
  std::array<std::uint32_t, 2> words_{};  ///< a 64-bit shift is dear on a 32-bit processor
};

}  // namespace proleg
