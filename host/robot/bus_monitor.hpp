#pragma once

// Shows the events on the bus of a robot to a person: listens, and reads the set-points of the modules.

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "host/robot/sdo_queue.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// The present knowledge about a node.
struct MonitoredNode {
  std::uint8_t node = 0;
  /// In the last heartbeat of the node; Pre-operational after a boot-up message.
  std::optional<canopen::NmtState> state;
  std::optional<std::int32_t> setpoint;     ///< 0x6062: 90 degrees = 2^30; nothing: not a joint module, or no answer
  std::optional<std::uint16_t> statusword;  ///< 0x6041
  // The newest of what was read and of the monitoring frame.
  std::optional<std::int32_t> position;        ///< 0x6064: 90 degrees = 2^30; nothing: not measured
  std::optional<std::int32_t> current_ma;      ///< 0x6078, of the servo
  std::optional<std::int32_t> temperature_c;   ///< 0x2009:2, of the chip
  std::optional<std::uint8_t> error_register;  ///< 0x1001
  /// Bits 0 to 3 as in the state frame; newest of the state frame and 0x2009:4.
  std::optional<std::uint8_t> contacts;
  std::optional<canopen::Emergency> last_emergency;  ///< the last one that was not the end of an error
  std::optional<std::uint16_t> current_limit;        ///< 0x200A:1, mA; 0: off; nothing: not known
  Microseconds last_heard = 0;
};

class BusMonitor final : public BusUser {
 public:
  /// Of a few modules. Of many they are longer, so that readings take at most about a sixth of the bus.
  static constexpr Microseconds reading_period_us = 500'000;
  static constexpr Microseconds touch_period_us = 100'000;

  /// port: must outlive the monitor.
  explicit BusMonitor(CanPort& port);
  BusMonitor(const BusMonitor&) = delete;
  BusMonitor& operator=(const BusMonitor&) = delete;

  /// Sets whether the monitor reads values from the modules; true at first. Without them it only listens.
  void set_reads(bool reads) { reads_ = reads; }
  /// Sets whether it reads the touch sensors of all modules, ten times a second while it reads; false at first. State
  /// frames have them while the robot is in operation.
  void set_reads_touch(bool reads) { reads_touch_ = reads; }
  /// Forgets nodes of which nothing was heard for three seconds: they may have another node id by now.
  void forget_silent(Microseconds now);
  /// Reads the limits of all modules again. Otherwise they are read once from each module, and again after its
  /// restart.
  void read_limits_again() { has_limit_.reset(); }

  [[nodiscard]] std::vector<MonitoredNode> nodes() const;
  /// Whether a host has sent a heartbeat in the last half second.
  [[nodiscard]] bool has_host(Microseconds now) const { return host_heard_ != 0 && now < host_heard_ + 500'000; }
  /// Numbers since the last call: SYNCs, frames of any kind (also of this host), and the share of the bus that they
  /// took, 0 to 1, with an average number of stuff bits.
  struct Traffic {
    unsigned syncs;
    std::uint64_t frames;
    double load;
  };
  [[nodiscard]] Traffic take_traffic(Microseconds now);

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  void count(const CanFrame& frame);
  [[nodiscard]] std::size_t heard_nodes() const;
  [[nodiscard]] bool is_silent(const MonitoredNode& node, Microseconds now) const;
  void read_values(Microseconds now);
  void read_touch(Microseconds now);
  void read_limit(MonitoredNode& node);

  SdoQueue readings_;
  std::array<MonitoredNode, canopen::host_node> nodes_{};
  std::bitset<canopen::host_node> has_limit_;    ///< by node: the node has answered, also that it has no limit
  std::bitset<canopen::host_node> lacks_touch_;  ///< by node: its program has no such object
  bool reads_ = true;
  bool reads_touch_ = false;
  Microseconds host_heard_ = 0;
  Microseconds next_reading_ = 0;
  Microseconds next_touch_ = 0;
  Microseconds traffic_from_ = 0;
  unsigned syncs_ = 0;
  std::uint64_t frames_ = 0;
  double bits_ = 0;
};

}  // namespace proleg::host
