#pragma once

// Plans the node ids of the modules of a robot, so that each joint has the module that its robot's file names.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/computer/master/lss_master.hpp"
#include "shared/computer/master/lss_renumbering.hpp"

namespace proleg::host {

/// A module on the bus, and the joint that it moves.
struct PlacedModule {
  std::uint8_t node = 0;
  canopen::LssAddress address{};
  std::optional<unsigned> joint;  ///< nothing: the module does not belong to the robot, or its joint is not known
};

/// Entries for the LSS master: the free node ids for modules without one. Those of the robot come first, in the order
/// of its joints, with the serial numbers that its file names (0: any); then all others. nodes, serials: by joint.
/// taken: node ids of other modules.
[[nodiscard]] std::vector<canopen::LssModule> free_node_ids(std::span<const std::uint8_t> nodes,
                                                            std::span<const std::uint32_t> serials,
                                                            std::span<const std::uint8_t> taken);

/// The node ids that modules must store, in this order, so that the module of joint j has nodes[j]. A module without a
/// joint whose node id is needed gets a free one. After each step no two modules have the same node id in their flash:
/// the sequence may be interrupted anywhere, and every module still boots. Two modules that exchange their node ids
/// therefore need a third one temporarily: one of them is listed twice. others: node ids of nodes that are not
/// modules; none of them is in `nodes`. Returns nothing if no node id is free for that, or if two modules have the
/// same joint.
[[nodiscard]] std::optional<std::vector<canopen::RenumberedModule>> plan_node_ids(std::span<const PlacedModule> modules,
                                                                                  std::span<const std::uint8_t> nodes,
                                                                                  std::span<const std::uint8_t> others);

}  // namespace proleg::host
