#pragma once

#include <optional>
#include <vector>

#include "host/robot/findings.hpp"

namespace proleg::host {

/// Why not one frame of another node was received; nothing if some were. It explains all else.
[[nodiscard]] std::optional<Finding> find_dead_bus(const BusObservations& observations, const BusAddress& address);

/// Errors on the wires, and a bus that is full.
[[nodiscard]] std::vector<Finding> find_wire_faults(const BusObservations& observations, const BusAddress& address);

}  // namespace proleg::host
