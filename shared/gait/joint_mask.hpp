#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace proleg {

/// Greatest number of joints of one robot; the receive objects 0x1410 + j of the protocol limit it.
inline constexpr unsigned max_joints = 64;

/// A set of joints: bit j stands for kernel joint j, which is the j-th from the head.
class JointMask {
 public:
  /// Visits the members from the head to the tail.
  class Iterator {
   public:
    explicit constexpr Iterator(std::uint64_t rest) : rest_(rest) {}
    constexpr unsigned operator*() const { return static_cast<unsigned>(std::countr_zero(rest_)); }
    constexpr Iterator& operator++() {
      rest_ &= rest_ - 1;
      return *this;
    }
    friend constexpr bool operator==(Iterator, Iterator) = default;

   private:
    std::uint64_t rest_;
  };

  constexpr JointMask() = default;
  explicit constexpr JointMask(std::uint64_t bits)
      : words_{static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32U)} {}

  /// The set of the joints 0 to count - 1. count is at most 64.
  [[nodiscard]] static constexpr JointMask first(unsigned count) {
    return JointMask(count >= max_joints ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1);
  }

  [[nodiscard]] static constexpr JointMask of(unsigned joint) { return JointMask(std::uint64_t{1} << joint); }

  [[nodiscard]] constexpr bool contains(unsigned joint) const {
    return joint < max_joints && ((words_[joint / 32] >> (joint % 32)) & 1U) != 0;
  }
  constexpr void insert(unsigned joint) { words_[joint / 32] |= 1U << (joint % 32); }
  constexpr void erase(unsigned joint) { words_[joint / 32] &= ~(1U << (joint % 32)); }
  [[nodiscard]] constexpr bool empty() const { return (words_[0] | words_[1]) == 0; }
  /// The member nearest to the head; the set must not be empty.
  [[nodiscard]] constexpr unsigned front() const { return *begin(); }
  /// Number of joints in the set.
  [[nodiscard]] constexpr unsigned size() const { return static_cast<unsigned>(std::popcount(bits())); }
  [[nodiscard]] constexpr std::uint64_t bits() const { return std::uint64_t{words_[1]} << 32U | words_[0]; }

  /// The nearest member in front of a joint, towards the head, or -1.
  [[nodiscard]] constexpr int before(unsigned joint) const {
    const std::uint64_t ahead = bits() & first(joint).bits();
    return ahead == 0 ? -1 : 63 - std::countl_zero(ahead);
  }

  /// The nearest member behind a joint, towards the tail, or -1.
  [[nodiscard]] constexpr int after(unsigned joint) const { return from(joint + 1); }

  /// The joint itself if it is a member, else the nearest member towards the tail, or -1.
  [[nodiscard]] constexpr int from(unsigned joint) const {
    const std::uint64_t rest = bits() & ~first(joint).bits();
    return rest == 0 ? -1 : std::countr_zero(rest);
  }

  [[nodiscard]] constexpr Iterator begin() const { return Iterator(bits()); }
  [[nodiscard]] static constexpr Iterator end() { return Iterator(0); }

  friend constexpr JointMask operator|(JointMask a, JointMask b) {
    return {a.words_[0] | b.words_[0], a.words_[1] | b.words_[1]};
  }
  friend constexpr JointMask operator&(JointMask a, JointMask b) {
    return {a.words_[0] & b.words_[0], a.words_[1] & b.words_[1]};
  }
  /// The members of `a` that are not in `b`.
  friend constexpr JointMask operator-(JointMask a, JointMask b) {
    return {a.words_[0] & ~b.words_[0], a.words_[1] & ~b.words_[1]};
  }
  constexpr JointMask& operator|=(JointMask other) { return *this = *this | other; }
  constexpr JointMask& operator-=(JointMask other) { return *this = *this - other; }

  friend constexpr bool operator==(JointMask, JointMask) = default;

 private:
  constexpr JointMask(std::uint32_t low, std::uint32_t high) : words_{low, high} {}

  std::array<std::uint32_t, 2> words_{};  ///< two words, because 64-bit shifts are expensive on a 32-bit processor
};

}  // namespace proleg
