#pragma once

// Finds faults of a bus and the robot on it, and describes them for a person who does not know CAN.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/robot/bus_observations.hpp"
#include "host/transport/bus_address.hpp"
#include "host/transport/can_interface.hpp"
#include "host/transport/serial_device.hpp"
#include "host/transport/transport.hpp"

namespace proleg::host {

struct Finding {
  std::string_view code;  ///< one word for programs, such as "duplicate_node_id"; see docs/robot-on-the-table.md
  std::string what;       ///< one sentence or two: what was found, and what it means
  std::string to_do;      ///< one sentence or two: what the person should do
  std::vector<std::uint8_t> nodes;  ///< nodes that have the fault
};

/// The text for some nodes: "node 3", "nodes 1, 2, 5".
[[nodiscard]] std::string nodes_text(const std::vector<std::uint8_t>& nodes);

// The four functions below find faults of the wires and of the drives. find_bus_faults() puts them in order with the
// others.

/// Finds the reason why no frame of another node was received, which explains all other faults; nothing if some were
/// received.
[[nodiscard]] std::optional<Finding> find_dead_bus(const BusObservations& observations, const BusAddress& address);

/// Finds lines of an slcan adapter that were not understood: damaged ones, or those of an unknown dialect.
[[nodiscard]] std::optional<Finding> find_damaged_lines(const BusObservations& observations, const BusAddress& address);

/// Finds errors on the wires, and a bus that is full.
[[nodiscard]] std::vector<Finding> find_wire_faults(const BusObservations& observations, const BusAddress& address);

/// Finds drives that have switched their servo off (Fault), by cause.
[[nodiscard]] std::vector<Finding> find_drive_faults(const BusObservations& observations);
/// Finds drives that hold their safe pose (quick stop).
[[nodiscard]] std::optional<Finding> find_quick_stop(const BusObservations& observations);

/// The known facts about the connection of this computer to the bus.
struct ConnectionFacts {
  struct Failure {
    TransportProblem problem = TransportProblem::other;
    std::string text;  ///< what() of the TransportError
  };

  BusAddress address;
  std::optional<CanInterface> can;     ///< settings of a CAN interface that exists
  std::optional<SerialDevice> serial;  ///< device of a serial address
  std::optional<Failure> failure;      ///< why the bus was not opened
};

/// The modules that are expected on the bus.
struct ExpectedModules {
  std::uint32_t core_fingerprint = 0;
};

/// Finds faults of the connection to the bus, the most fundamental one first. As long as there is one that blocks()
/// the bus, it must not be opened, or cannot be.
[[nodiscard]] std::vector<Finding> find_connection_faults(const ConnectionFacts& facts);
/// Whether the bus cannot be examined before the finding has been dealt with.
[[nodiscard]] bool blocks(const Finding& finding);

/// Finds faults of the bus and the robot, the most fundamental one first. A fault that another finding explains is not
/// reported.
[[nodiscard]] std::vector<Finding> find_bus_faults(const BusObservations& observations, const BusAddress& address,
                                                   const ExpectedModules& expected);

}  // namespace proleg::host
