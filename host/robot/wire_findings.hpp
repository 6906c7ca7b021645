#pragma once

#include <optional>
#include <vector>

#include "host/robot/findings.hpp"

namespace proleg::host {

/// Finds the reason why no frame of another node was received, which explains all other faults; nothing if some were
/// received.
[[nodiscard]] std::optional<Finding> find_dead_bus(const BusObservations& observations, const BusAddress& address);

/// Finds errors on the wires, and a bus that is full.
[[nodiscard]] std::vector<Finding> find_wire_faults(const BusObservations& observations, const BusAddress& address);

}  // namespace proleg::host
