#pragma once

#include <cstdint>
#include <optional>
#include <random>

#include "host/robot/bus_user.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// A token for the lease of a robot (object 0x2002): not 0, and different from that of any other host.
[[nodiscard]] inline std::uint32_t random_token() {
  std::random_device device;
  return std::uniform_int_distribution<std::uint32_t>(1)(device);
}

/// Finds out by heartbeats whether another host drives the robot. A host sends one each 100 ms. On a busy computer
/// some are late, and a last one of a host that has just ended may still be under way.
class HostPresence final : public BusUser {
 public:
  explicit HostPresence(Microseconds now) : begin_(now) {}

  void receive(Microseconds now, const CanFrame& frame) override {
    const auto heartbeat = canopen::decode_heartbeat(frame);
    if (heartbeat && heartbeat->node == canopen::host_node) {
      first_ = first_.value_or(now);
      last_ = now;
    }
  }

  /// Whether a host is present: heartbeats were received for longer than those of a host that has ended.
  [[nodiscard]] bool is_there() const { return first_ && *last_ - *first_ >= three_heartbeats_us; }
  /// The time at which it is certain that no host is present, unless a heartbeat is received before.
  [[nodiscard]] Microseconds silent_at() const { return last_.value_or(begin_) + longest_silence_us; }

 private:
  static constexpr Microseconds three_heartbeats_us = 300'000;
  static constexpr Microseconds longest_silence_us = 500'000;

  Microseconds begin_;
  std::optional<Microseconds> first_;
  std::optional<Microseconds> last_;
};

}  // namespace proleg::host
