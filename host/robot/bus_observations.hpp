#pragma once

// What was seen on a bus, as numbers; findings.hpp has what they mean.

#include <cstdint>
#include <optional>
#include <vector>

#include "host/robot/bus_scan.hpp"
#include "host/transport/transport.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// The end of the bus at this computer.
struct OwnEnd {
  BusState state;
  Statistics statistics;
};

struct ObservedNode {
  std::uint8_t node = 0;
  std::optional<canopen::NmtState> state;  ///< by its last heartbeat; nothing: it sends none
  unsigned boot_ups = 0;
  /// Codes of its EMCYs that were no end of an error, each once, in their order.
  std::vector<canopen::EmergencyCode> emergencies;
  std::optional<ScannedNode> answers;  ///< nothing: it has answered no request
  // Of a joint module that answers:
  bool produces_sync = false;                       ///< by 0x1005
  std::vector<canopen::EmergencyCode> past_errors;  ///< by 0x1003, the newest first
};

/// A module that answers LSS only: it is Stopped, or has no node id.
struct SilentModule {
  std::uint32_t serial = 0;             ///< 0x1018:4
  std::optional<std::uint8_t> node_id;  ///< nothing: it has none
  std::uint32_t product = 0;            ///< 0x1018:2

  friend bool operator==(const SilentModule&, const SilentModule&) = default;
};

struct BusObservations {
  // While nothing was sent:
  Microseconds listened_us = 0;
  std::uint64_t frames = 0;
  std::uint64_t errors = 0;  ///< that the own controller has reported
  double load = 0;           ///< share of the bus, 0 to 1, with an average number of stuff bits
  std::uint16_t busiest_identifier = 0;
  double busiest_load = 0;       ///< of the frames with that identifier
  unsigned syncs = 0;            ///< SYNCs with a counter
  unsigned sync_jumps = 0;       ///< of these: the counter is that of the one before, or goes back
  unsigned foreign_syncs = 0;    ///< SYNCs without a counter
  unsigned host_heartbeats = 0;  ///< heartbeats of node 127

  // All the time:
  bool was_asked = false;           ///< requests were sent, else only listening was possible
  bool is_complete = false;         ///< all requests ended
  std::vector<ObservedNode> nodes;  ///< by node id
  bool has_fresh_modules = false;
  std::vector<SilentModule> silent_modules;
  OwnEnd own;                                                ///< at the end; frames and errors since the start
  CanState worst_controller_state = CanState::error_active;  ///< of the own controller
};

}  // namespace proleg::host
