#pragma once

// What is wrong with a bus and the robot on it, in words for a person who does not know CAN.

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

/// What is known about this computer's way to the bus.
struct ConnectionFacts {
  struct Failure {
    TransportProblem problem = TransportProblem::other;
    std::string text;  ///< what() of the TransportError
  };

  BusAddress address;
  std::optional<CanInterface> can;     ///< of a CAN interface that exists
  std::optional<SerialDevice> serial;  ///< of a serial address
  std::optional<Failure> failure;      ///< the bus was not opened
};

/// What the modules are compared with.
struct ExpectedModules {
  std::uint32_t core_fingerprint = 0;
};

/// Faults of the way to the bus, the most fundamental one first. As long as there is one that blocks() it, the bus must
/// not be opened, or cannot be.
[[nodiscard]] std::vector<Finding> find_connection_faults(const ConnectionFacts& facts);
/// Whether the bus cannot be examined before the finding has been dealt with.
[[nodiscard]] bool blocks(const Finding& finding);

/// Faults of the bus and the robot, the most fundamental one first. What a finding explains is no finding of its own.
[[nodiscard]] std::vector<Finding> find_bus_faults(const BusObservations& observations, const BusAddress& address,
                                                   const ExpectedModules& expected);

}  // namespace proleg::host
