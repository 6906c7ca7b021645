#pragma once

#include "shared/can/can_port.hpp"

namespace proleg::firmware {

/// Misses the heartbeat of the host (CiA 301, consumer heartbeat time, object 0x1016).
class HostWatch {
 public:
  /// As in 0x1016: 65536 * node + longest silence in ms; 0 ms: none is expected. Nothing is missed before the first
  /// heartbeat was heard.
  void set(std::uint32_t expected) {
    expected_ = expected;
    silence_ends_ = never;
  }
  [[nodiscard]] std::uint32_t expected() const { return expected_; }

  /// A heartbeat of any node.
  void heard(Microseconds now, std::uint8_t node) {
    const std::uint32_t silence_ms = expected_ & 0xFFFFU;
    if (silence_ms != 0 && node == expected_ >> 16U) {
      silence_ends_ = now + Microseconds{silence_ms} * 1'000U;
    }
  }
  /// Whether the host is heard and not yet missed.
  [[nodiscard]] bool present() const { return silence_ends_ != never; }
  /// Whether the host is missed from now on; told once.
  [[nodiscard]] bool missed(Microseconds now) {
    if (now < silence_ends_) {
      return false;
    }
    silence_ends_ = never;
    return true;
  }
  [[nodiscard]] Microseconds next_deadline() const { return silence_ends_; }

 private:
  std::uint32_t expected_ = 0;
  Microseconds silence_ends_ = never;
};

}  // namespace proleg::firmware
