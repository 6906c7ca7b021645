#pragma once

#include "firmware/module/emergencies.hpp"
#include "firmware/module/joint_kernel.hpp"

namespace proleg::firmware {

/// Passes the state frames of the other joints to the kernel, and reports wrong ones.
class StateReceiver {
 public:
  StateReceiver(JointKernel& joint, Emergencies& emergencies, CanPort& port)
      : joint_(joint), emergencies_(emergencies), port_(port) {}

  /// Whether the nodes of the settings are possible: no node has two joints, and no other joint has the module's own
  /// node.
  [[nodiscard]] static bool accepts(const ModuleSettings& settings, std::uint8_t own_node);
  /// Receives from now on from the nodes whose joints this joint depends on. The joint must be active, and the settings
  /// accepted.
  void configure(const ModuleSettings& settings);
  /// Receives from no node.
  void stop();
  /// Forgets which errors were reported: errors of each joint are reported again.
  void clear_reported_errors();

  /// Takes a frame on the identifier of the state frame of `node`, 1 to 127. synchronised: whether a label that is more
  /// than a tick away from the coming one is an error.
  void receive(const CanFrame& frame, unsigned channel, std::uint8_t node, bool synchronised);

  /// Number of frames whose label was more than a tick away from the coming one.
  [[nodiscard]] std::uint32_t unknown_labels() const { return unknown_labels_; }

 private:
  /// For each node, one more than the joint whose state frames it sends; 0: none.
  using JointOfNode = std::array<std::uint8_t, canopen::host_node + 1U>;

  JointKernel& joint_;
  Emergencies& emergencies_;
  CanPort& port_;
  std::array<JointOfNode, max_channels> joints_{};
  JointMask reported_length_;  ///< joints whose wrong length was reported
  JointMask reported_label_;   ///< joints whose unknown label was reported
  std::uint32_t unknown_labels_ = 0;
};

}  // namespace proleg::firmware
