#pragma once

#include "host/robot/bus_connection.hpp"

namespace proleg::tools {

/// Shows other hosts, while it exists and is active, that a host works on this robot: then they change nothing.
class HostPresence final : public host::BusUser {
 public:
  explicit HostPresence(host::BusConnection& bus) : bus_(bus), attachment_(bus, *this) {}

  /// A master sends heartbeats itself.
  void set_active(bool is_active) { is_active_ = is_active; }

  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override { return is_active_ ? next_ : never; }

 private:
  host::BusConnection& bus_;
  host::BusAttachment attachment_;
  bool is_active_ = true;
  Microseconds next_ = 0;
};

}  // namespace proleg::tools
