#pragma once

#include <cstdint>
#include <optional>

namespace proleg::canopen {

/// Knows the robot's tick from TICK, which announces that of the SYNC behind it, and from the counters of SYNC.
class TickFollower {
 public:
  void announce(std::uint32_t tick) { announced_ = tick; }

  /// counter: 1 to 128.
  void sync(std::uint8_t counter) {
    if (announced_ && counter_of(*announced_) == counter) {
      tick_ = announced_;
    } else if (tick_) {
      const std::uint32_t steps = (counter - counter_of(*tick_)) % counters;  // 0: the same once more
      *tick_ += steps;
    }
    announced_.reset();
  }

  /// Of the last SYNC; nothing as long as it is not known.
  [[nodiscard]] std::optional<std::uint32_t> tick() const { return tick_; }

 private:
  static constexpr std::uint32_t counters = 128;

  [[nodiscard]] static std::uint32_t counter_of(std::uint32_t tick) { return tick % counters + 1U; }

  std::optional<std::uint32_t> tick_;
  std::optional<std::uint32_t> announced_;
};

}  // namespace proleg::canopen
