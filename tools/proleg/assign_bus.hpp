#pragma once

// What proleg assign does on the bus, step by step. All of it throws std::runtime_error: what failed, and what to do.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/robot/joint_motion.hpp"
#include "host/robot/node_plan.hpp"
#include "tools/proleg/bus_access.hpp"

namespace proleg::tools {

/// Resets all modules, and waits until they have booted.
void reset_all(BusAccess& bus);

/// Gives every module without a node id one that is free: those of the robot first. nodes, serials: as for
/// host::free_node_ids().
void number_fresh_modules(BusAccess& bus, std::span<const std::uint8_t> nodes, std::span<const std::uint32_t> serials);

/// The joint modules on the bus, by node id; at least one. Their joints are not known.
[[nodiscard]] std::vector<host::PlacedModule> find_modules(BusAccess& bus);

/// The modules store their new node ids and boot with them.
void renumber(BusAccess& bus, std::span<const canopen::RenumberedModule> changes);

/// A joint that moves to and fro while this exists.
class MovingJoint {
 public:
  /// Returns when the joint moves.
  MovingJoint(BusAccess& bus, std::uint8_t node, const host::JointMotionOptions& options);
  /// Without stop(): takes the power as well as it can.
  ~MovingJoint();
  MovingJoint(const MovingJoint&) = delete;
  MovingJoint& operator=(const MovingJoint&) = delete;

  /// Returns when the servo has no power.
  void stop();
  [[nodiscard]] const host::JointMotion& motion() const { return motion_; }

 private:
  bool try_to_stop();

  BusAccess& bus_;
  host::JointMotion motion_;
  bool is_off_ = false;
};

}  // namespace proleg::tools
