#pragma once

// What proleg assign does on the bus, step by step. All of it throws std::runtime_error: what failed, and what to do.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/robot/joint_motion.hpp"
#include "host/robot/node_plan.hpp"
#include "tools/proleg/bus_access.hpp"

namespace proleg::tools {

/// Shows other hosts, while it exists and is active, that a host works on this robot: then they change nothing.
class HostPresence final : public host::BusUser {
 public:
  explicit HostPresence(host::BusConnection& bus) : bus_(bus) { bus_.attach(*this); }
  ~HostPresence() { bus_.detach(*this); }
  HostPresence(const HostPresence&) = delete;
  HostPresence& operator=(const HostPresence&) = delete;

  /// A master sends heartbeats itself.
  void set_active(bool is_active) { is_active_ = is_active; }

  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override { return is_active_ ? next_ : never; }

 private:
  host::BusConnection& bus_;
  bool is_active_ = true;
  Microseconds next_ = 0;
};

/// Resets all modules, and waits until they have booted. Refuses a bus with two modules of one node id: they stop, and
/// answer nothing afterwards.
void reset_all(BusAccess& bus);

/// Gives every module without a node id one that is free: those of the robot first. nodes, serials: as for
/// host::free_node_ids(). Returns how many there were.
unsigned number_fresh_modules(BusAccess& bus, std::span<const std::uint8_t> nodes,
                              std::span<const std::uint32_t> serials);

/// Who is on the bus.
struct FoundModules {
  std::vector<host::PlacedModule> modules;  ///< by node id, at least one; their joints are not known
  std::vector<std::uint8_t> others;         ///< node ids of nodes that are no joint modules, or do not answer
};
[[nodiscard]] FoundModules find_modules(BusAccess& bus);

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
  /// To be called from time to time while it moves.
  void take_events();
  /// Why it does not move any more.
  [[nodiscard]] std::string problem() const;

 private:
  bool try_to_stop();
  void stop_after_failure() noexcept;

  BusAccess& bus_;
  host::JointMotion motion_;
  bool is_off_ = false;
  bool is_confirmed_ = true;  ///< no module has left out the confirmation that its servo has no power
};

}  // namespace proleg::tools
