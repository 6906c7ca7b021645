#include "firmware/module/state_receiver.hpp"

namespace proleg::firmware {

bool StateReceiver::configure(const Settings& settings, std::uint8_t own_node) {
  std::array<JointOfNode, max_channels> joints{};
  for (unsigned channel = 0; channel < max_channels; ++channel) {
    for (unsigned joint = 0; joint < settings.joint_count; ++joint) {
      const std::uint8_t node = settings.nodes[channel][joint];
      if (node == 0 || joint == settings.joint) {
        continue;
      }
      if (node == own_node || joints[channel][node] != 0) {
        return false;
      }
      joints[channel][node] = static_cast<std::uint8_t>(joint + 1U);
    }
  }
  joints_ = joints;
  return true;
}

void StateReceiver::forget_complaints() {
  wrong_length_ = {};
  wrong_label_ = {};
  unknown_labels_ = 0;
}

void StateReceiver::receive(const CanFrame& frame, unsigned channel, std::uint8_t node, bool synchronised) {
  if (joints_[channel][node] == 0) {
    return;
  }
  const unsigned joint = joints_[channel][node] - 1U;
  const std::optional<StateFrame> state = canopen::decode_state(frame);
  if (!state) {
    if (!wrong_length_.contains(joint)) {
      wrong_length_.insert(joint);
      emergencies_.report(canopen::EmergencyCode::wrong_length, joint);
    }
    return;
  }
  // How far the label is from the coming tick, plus one: 0 to 2 for those of a module that has just computed, or has
  // not yet.
  const auto distance = static_cast<std::uint8_t>(state->label() - joint_.kernel().tick() + 1U);
  if (distance > 2) {
    ++unknown_labels_;
    if (synchronised && !wrong_label_.contains(joint)) {
      wrong_label_.insert(joint);
      emergencies_.report(canopen::EmergencyCode::unknown_label, joint);
    }
  }
  joint_.receive(joint, channel, *state);
}

}  // namespace proleg::firmware
