#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/canopen/messages.hpp"
#include "shared/kernel/kernel.hpp"
#include "sim/bus/bus.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The state frames on the bus: which modules have sent theirs since the last SYNC, and which deliveries are losses.
/// Controllers of the bus have the index of their joint.
class StateFrameMonitor {
 public:
  /// scenario: must outlive this.
  explicit StateFrameMonitor(const Scenario& scenario);

  /// Begins a tick at SYNC k: the state frames that follow carry the label k + 1.
  void begin_tick(std::uint32_t tick);
  /// A frame has ended on the bus.
  void note(const Transmission& transmission);
  /// Whether the module of a joint has sent its first state frame since the last SYNC.
  [[nodiscard]] bool has_sent(unsigned joint) const { return sent_.contains(joint); }

  /// Whether the losses withhold a frame from a receiver, given by the index of its controller.
  [[nodiscard]] bool is_lost(const Losses& losses, const CanFrame& frame, std::size_t receiver) const;

 private:
  static constexpr unsigned no_joint = max_joints;

  const Scenario& scenario_;
  std::array<unsigned, canopen::max_node_id + 1> joint_of_node_{};
  std::uint32_t label_ = 0;
  JointMask sent_;
};

}  // namespace proleg::sim
