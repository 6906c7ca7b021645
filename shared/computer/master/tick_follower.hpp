#pragma once

#include <cstdint>
#include <optional>

#include "shared/canopen/messages.hpp"

namespace proleg::canopen {

/// Follows the robot's tick by TICK, which announces the tick of the next SYNC, and by the counter of SYNC.
class TickFollower {
 public:
  void announce(std::uint32_t tick) { announced_ = tick; }

  /// Takes a SYNC. counter: 1 to 128.
  void sync(std::uint8_t counter) {
    if (announced_ && sync_counter(*announced_) == counter) {
      tick_ = announced_;
    } else if (tick_) {
      *tick_ += ticks_until_counter(*tick_, counter);  // a repeated SYNC adds 0
    }
    announced_.reset();
  }

  /// The tick of the last SYNC; nothing before the first TICK and its SYNC.
  [[nodiscard]] std::optional<std::uint32_t> tick() const { return tick_; }

 private:
  std::optional<std::uint32_t> tick_;
  std::optional<std::uint32_t> announced_;
};

}  // namespace proleg::canopen
