#include "host/robot/node_plan.hpp"

#include <bitset>

namespace proleg::host {
namespace {

using NodeSet = std::bitset<canopen::host_node>;

NodeSet set_of(std::span<const std::uint8_t> nodes) {
  NodeSet set;
  for (const std::uint8_t node : nodes) {
    set.set(node);
  }
  return set;
}

}  // namespace

std::vector<canopen::LssModule> free_node_ids(std::span<const std::uint8_t> nodes,
                                              std::span<const std::uint32_t> serials,
                                              std::span<const std::uint8_t> taken) {
  const NodeSet of_robot = set_of(nodes);
  const NodeSet of_others = set_of(taken);
  std::vector<canopen::LssModule> entries;
  for (std::size_t joint = 0; joint < nodes.size(); ++joint) {
    if (!of_others.test(nodes[joint])) {
      entries.push_back({nodes[joint], joint < serials.size() ? serials[joint] : 0});
    }
  }
  for (std::uint8_t node = canopen::min_node_id; node <= canopen::max_node_id; ++node) {
    if (!of_robot.test(node) && !of_others.test(node)) {
      entries.push_back({node});
    }
  }
  return entries;
}

std::vector<canopen::RenumberedModule> plan_node_ids(std::span<const PlacedModule> modules,
                                                     std::span<const std::uint8_t> nodes) {
  // Ids of joints stay free for their modules, also for those that are not on the bus today.
  NodeSet taken = set_of(nodes);
  for (const PlacedModule& module : modules) {
    taken.set(module.node);
  }
  const NodeSet of_robot = set_of(nodes);
  std::vector<canopen::RenumberedModule> renumbered;
  for (const PlacedModule& module : modules) {
    std::uint8_t wanted = module.node;
    if (module.joint) {
      wanted = nodes[*module.joint];
    } else if (of_robot.test(module.node)) {
      for (wanted = canopen::min_node_id; wanted < canopen::max_node_id && taken.test(wanted); ++wanted) {
      }
      taken.set(wanted);
    }
    if (wanted != module.node) {
      renumbered.push_back({module.address, wanted});
    }
  }
  return renumbered;
}

}  // namespace proleg::host
