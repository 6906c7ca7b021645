#pragma once

#include <optional>

#include "host/robot/bus_user.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// Whether another host drives the robot: listens to its heartbeats. A host sends one each 100 ms. On a busy computer
/// some are late; and of a host that has just ended a last one may still be on its way.
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

  /// Heartbeats came for longer than those of a host that has ended.
  [[nodiscard]] bool is_there() const { return first_ && *last_ - *first_ >= three_heartbeats_us; }
  /// When it is sure that there is none, unless one is heard before.
  [[nodiscard]] Microseconds silent_at() const { return last_.value_or(begin_) + longest_silence_us; }

 private:
  static constexpr Microseconds three_heartbeats_us = 300'000;
  static constexpr Microseconds longest_silence_us = 500'000;

  Microseconds begin_;
  std::optional<Microseconds> first_;
  std::optional<Microseconds> last_;
};

}  // namespace proleg::host
