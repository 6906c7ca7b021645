#pragma once

// The observations of a bus, as numbers; findings.hpp has their meaning.

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
  std::optional<canopen::NmtState> state;  ///< state in the last heartbeat; nothing: the node sends no heartbeats
  unsigned boot_ups = 0;
  /// Codes of the EMCYs of the node, each once, in their order, without those that report the end of an error.
  std::vector<canopen::EmergencyCode> emergencies;
  std::optional<ScannedNode> answers;  ///< answers to the scan; nothing: the node has answered no request
  // The members below are for a joint module that answers.
  bool produces_sync = false;                       ///< whether the module produces SYNC, as 0x1005 says
  bool has_current_sensor = true;                   ///< false: 0x2000:5 says that nothing measures the servo's current
  bool has_brown_out_reset = true;                  ///< false: 0x2000:5 was read, and does not have this bit
  std::vector<canopen::EmergencyCode> past_errors;  ///< errors in 0x1003, the newest first
};

/// A module that answers LSS only, because it is Stopped or has no node id.
struct SilentModule {
  std::uint32_t serial = 0;             ///< 0x1018:4
  std::optional<std::uint8_t> node_id;  ///< nothing: the module has no node id
  std::uint32_t product = 0;            ///< 0x1018:2

  friend bool operator==(const SilentModule&, const SilentModule&) = default;
};

struct BusObservations {
  // The members below describe the time in which nothing was sent.
  Microseconds listened_us = 0;
  std::uint64_t frames = 0;
  std::uint64_t errors = 0;  ///< number of errors that the own controller has reported
  double load = 0;           ///< share of the bus, 0 to 1, with an average number of stuff bits
  std::uint16_t busiest_identifier = 0;
  double busiest_load = 0;       ///< load by the frames with that identifier
  unsigned syncs = 0;            ///< SYNCs with a counter
  unsigned sync_jumps = 0;       ///< number of these whose counter is that of the previous SYNC, or goes back
  unsigned foreign_syncs = 0;    ///< SYNCs without a counter
  unsigned host_heartbeats = 0;  ///< heartbeats of node 127

  // The members below describe all the time.
  bool was_asked = false;           ///< requests were sent, else only listening was possible
  bool is_complete = false;         ///< all requests ended
  std::vector<ObservedNode> nodes;  ///< nodes in the order of node ids
  bool has_fresh_modules = false;
  std::vector<SilentModule> silent_modules;
  OwnEnd own;  ///< own end when the examination ended; frames and errors since the start
  CanState worst_controller_state = CanState::error_active;  ///< worst state of the own controller
};

}  // namespace proleg::host
