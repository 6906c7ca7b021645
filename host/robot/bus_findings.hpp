#pragma once

// Findings of the wires and of the drives. find_bus_faults() puts them in order with the others.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/robot/bus_observations.hpp"
#include "host/transport/bus_address.hpp"

namespace proleg::host {

struct Finding {
  std::string_view code;  ///< one word for programs, such as "duplicate_node_id"; see docs/robot-on-the-table.md
  std::string what;       ///< one sentence or two: what was found, and what it means
  std::string to_do;      ///< the same: what the person does
  std::vector<std::uint8_t> nodes;  ///< that it is about
};

/// "node 3", "nodes 1, 2, 5".
[[nodiscard]] std::string nodes_text(const std::vector<std::uint8_t>& nodes);

/// Why not one frame of another node was received; nothing if some were. It explains all else.
[[nodiscard]] std::optional<Finding> find_dead_bus(const BusObservations& observations, const BusAddress& address);

/// Errors on the wires, and a bus that is full.
[[nodiscard]] std::vector<Finding> find_wire_faults(const BusObservations& observations, const BusAddress& address);

/// Drives that have switched their servo off (Fault), by cause.
[[nodiscard]] std::vector<Finding> find_drive_faults(const BusObservations& observations);
/// Drives that hold their safe pose (quick stop).
[[nodiscard]] std::optional<Finding> find_quick_stop(const BusObservations& observations);

}  // namespace proleg::host
