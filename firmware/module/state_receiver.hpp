#pragma once

#include "firmware/module/emergencies.hpp"
#include "firmware/module/joint_kernel.hpp"

namespace proleg::firmware {

/// Hands the state frames of the other joints to the kernel, and complains of those that cannot be meant.
class StateReceiver {
 public:
  StateReceiver(JointKernel& joint, Emergencies& emergencies, CanPort& port)
      : joint_(joint), emergencies_(emergencies), port_(port) {}

  /// Whether the nodes of the settings can be meant: none has two joints, and no other joint the module's own node.
  [[nodiscard]] static bool accepts(const Settings& settings, std::uint8_t own_node);
  /// Listens to those nodes of the settings whose joints matter to the joint; it is active, and the settings are
  /// accepted.
  void configure(const Settings& settings);
  /// Listens to nobody.
  void stop();
  /// Each joint may be complained of once more.
  void forget_complaints();

  /// A frame on the identifier of the state frame of `node`, 1 to 127. synchronised: a label that is more than a tick
  /// away from the coming one is an error.
  void receive(const CanFrame& frame, unsigned channel, std::uint8_t node, bool synchronised);

  /// Frames whose label was more than a tick away from the coming one.
  [[nodiscard]] std::uint32_t unknown_labels() const { return unknown_labels_; }

 private:
  /// For each node: one more than the joint whose state frames it sends; 0: none.
  using JointOfNode = std::array<std::uint8_t, canopen::host_node + 1U>;

  JointKernel& joint_;
  Emergencies& emergencies_;
  CanPort& port_;
  std::array<JointOfNode, max_channels> joints_{};
  JointMask wrong_length_;  ///< joints that were complained of
  JointMask wrong_label_;
  std::uint32_t unknown_labels_ = 0;
};

}  // namespace proleg::firmware
