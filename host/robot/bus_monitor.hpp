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
  std::optional<canopen::NmtState> state;   ///< state in the last heartbeat of the node
  std::optional<std::int32_t> setpoint;     ///< 0x6062: 90 degrees = 2^30; nothing: not a joint module, or no answer
  std::optional<std::uint16_t> statusword;  ///< 0x6041
  std::optional<canopen::Monitoring> measured;  ///< angle, current, temperature, error register
  std::optional<std::int32_t> position;  ///< newest of 0x6064 and `measured`: 90 degrees = 2^30; nothing: not measured
  std::optional<std::uint8_t> contacts;  ///< bits 0 to 3 as in the state frame
  std::optional<canopen::Emergency> last_emergency;  ///< the last one that was not the end of an error
  std::optional<std::uint16_t> current_limit;        ///< 0x200A:1, mA; 0: off; nothing: not known
  Microseconds last_heard = 0;
};

class BusMonitor final : public BusUser {
 public:
  static constexpr Microseconds reading_period_us = 500'000;

  /// port: must outlive the monitor.
  explicit BusMonitor(CanPort& port);
  BusMonitor(const BusMonitor&) = delete;
  BusMonitor& operator=(const BusMonitor&) = delete;

  /// Sets whether the monitor reads values from the modules; true at first. Without them it only listens.
  void set_reads(bool reads) { reads_ = reads; }
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
  void read_values(Microseconds now);
  void read_limit(MonitoredNode& node);

  SdoQueue readings_;
  std::array<MonitoredNode, canopen::host_node> nodes_{};
  std::bitset<canopen::host_node> has_limit_;  ///< by node: the node has answered, also that it has no limit
  bool reads_ = true;
  Microseconds host_heard_ = 0;
  Microseconds next_reading_ = 0;
  Microseconds traffic_from_ = 0;
  unsigned syncs_ = 0;
  std::uint64_t frames_ = 0;
  double bits_ = 0;
};

}  // namespace proleg::host
