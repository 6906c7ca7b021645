#pragma once

// Finds faults of a bus and the robot on it, and describes them for a person who does not know CAN.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/robot/bus_findings.hpp"
#include "host/robot/bus_observations.hpp"
#include "host/transport/bus_address.hpp"
#include "host/transport/can_interface.hpp"
#include "host/transport/serial_device.hpp"
#include "host/transport/transport.hpp"

namespace proleg::host {

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
