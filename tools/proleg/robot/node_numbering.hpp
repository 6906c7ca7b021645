#pragma once

// Node ids for modules on the bus, by LSS. All of it throws std::runtime_error: what failed, and what to do.

#include <cstdint>
#include <span>
#include <string>

#include "shared/computer/master/lss_renumbering.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

/// Gives every module without a node id one that is free: those of the robot first. nodes, serials: as for
/// host::free_node_ids(). taken: node ids that are not free, beside those that a scan finds. Returns how many there
/// were.
unsigned number_fresh_modules(BusAccess& bus, std::span<const std::uint8_t> nodes,
                              std::span<const std::uint32_t> serials, std::span<const std::uint8_t> taken = {});

/// The modules store their new node ids and boot with them. What they have done is in `modules`, also after an
/// exception. reset_node: as LssRenumberingOptions has it.
void renumber(BusAccess& bus, std::span<canopen::RenumberedModule> modules, std::uint8_t reset_node = 0);

}  // namespace proleg::tools
