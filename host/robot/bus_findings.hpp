#pragma once

// Finds faults of the wires and of the drives. find_bus_faults() puts them in order with the others.

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
  std::string to_do;      ///< one sentence or two: what the person should do
  std::vector<std::uint8_t> nodes;  ///< nodes that have the fault
};

/// The text for some nodes: "node 3", "nodes 1, 2, 5".
[[nodiscard]] std::string nodes_text(const std::vector<std::uint8_t>& nodes);

/// Finds the reason why no frame of another node was received, which explains all other faults; nothing if some were
/// received.
[[nodiscard]] std::optional<Finding> find_dead_bus(const BusObservations& observations, const BusAddress& address);

/// Finds errors on the wires, and a bus that is full.
[[nodiscard]] std::vector<Finding> find_wire_faults(const BusObservations& observations, const BusAddress& address);

/// Finds drives that have switched their servo off (Fault), by cause.
[[nodiscard]] std::vector<Finding> find_drive_faults(const BusObservations& observations);
/// Finds drives that hold their safe pose (quick stop).
[[nodiscard]] std::optional<Finding> find_quick_stop(const BusObservations& observations);

}  // namespace proleg::host
