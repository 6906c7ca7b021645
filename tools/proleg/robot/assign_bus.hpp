#pragma once

// What proleg assign does on the bus, step by step. All of it throws std::runtime_error: what failed, and what to do.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/robot/joint_motion.hpp"
#include "host/robot/node_plan.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

/// Resets all modules, and waits until they have booted. Refuses a bus with two modules of one node id: they stop, and
/// answer nothing afterwards.
void reset_all(BusAccess& bus);

/// Who is on the bus.
struct ModulesToNumber {
  std::vector<host::PlacedModule> modules;  ///< by node id, at least one; their joints are not known
  std::vector<std::uint8_t> others;         ///< node ids of nodes that are no joint modules, or do not answer
};
[[nodiscard]] ModulesToNumber find_modules_to_number(BusAccess& bus);

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
  /// To be called from time to time while it moves.
  void take_events();
  /// Why it does not move any more.
  [[nodiscard]] std::string problem() const;

 private:
  bool try_to_stop();
  void stop_after_failure() noexcept;

  BusAccess& bus_;
  host::JointMotion motion_;
  host::BusAttachment attachment_;
  bool is_off_ = false;
  bool is_confirmed_ = true;  ///< no module has left out the confirmation that its servo has no power
};

}  // namespace proleg::tools
