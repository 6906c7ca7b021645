#include "host/robot/node_plan.hpp"

#include <algorithm>
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

/// The lowest node id that is not in the set.
std::optional<std::uint8_t> lowest_free(const NodeSet& taken) {
  for (std::uint8_t node = canopen::min_node_id; node <= canopen::max_node_id; ++node) {
    if (!taken.test(node)) {
      return node;
    }
  }
  return std::nullopt;
}

/// A module whose node id must change.
struct Move {
  const PlacedModule* module;
  std::uint8_t from;  ///< node id in the flash of the module
  std::uint8_t to;
};

bool have_joints_of_their_own(std::span<const PlacedModule> modules) {
  for (std::size_t i = 0; i < modules.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (modules[i].joint && modules[i].joint == modules[j].joint) {
        return false;
      }
    }
  }
  return true;
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

std::optional<std::vector<canopen::RenumberedModule>> plan_node_ids(std::span<const PlacedModule> modules,
                                                                    std::span<const std::uint8_t> nodes,
                                                                    std::span<const std::uint8_t> others) {
  if (!have_joints_of_their_own(modules)) {
    return std::nullopt;
  }
  const NodeSet of_robot = set_of(nodes);
  // Ids of joints stay free for their modules, also for those that are not on the bus today.
  NodeSet taken = of_robot | set_of(others);
  for (const PlacedModule& module : modules) {
    taken.set(module.node);
  }
  std::vector<Move> moves;
  for (const PlacedModule& module : modules) {
    if (module.joint) {
      moves.push_back({&module, module.node, nodes[*module.joint]});
    } else if (of_robot.test(module.node)) {
      const auto free = lowest_free(taken);
      if (!free) {
        return std::nullopt;
      }
      taken.set(*free);
      moves.push_back({&module, module.node, *free});
    }
  }
  std::erase_if(moves, [](const Move& move) { return move.from == move.to; });

  std::vector<canopen::RenumberedModule> steps;
  while (!moves.empty()) {
    // A move whose target no other module has in its flash.
    const auto next = std::ranges::find_if(moves, [&](const Move& move) {
      return std::ranges::none_of(moves, [&](const Move& other) { return other.from == move.to; });
    });
    if (next != moves.end()) {
      steps.push_back({next->module->address, next->to});
      moves.erase(next);
      continue;
    }
    // All remaining moves wait for each other.
    const auto aside = lowest_free(taken);
    if (!aside) {
      return std::nullopt;
    }
    steps.push_back({moves.front().module->address, *aside});
    moves.front().from = *aside;
  }
  return steps;
}

}  // namespace proleg::host
