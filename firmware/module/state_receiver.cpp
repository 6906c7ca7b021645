#include "firmware/module/state_receiver.hpp"

namespace proleg::firmware {

bool StateReceiver::accepts(const ModuleSettings& settings, std::uint8_t own_node) {
  for (unsigned channel = 0; channel < max_channels; ++channel) {
    std::array<bool, canopen::host_node + 1U> has_joint{};
    for (unsigned joint = 0; joint < settings.joint_count; ++joint) {
      const std::uint8_t node = settings.nodes[channel][joint];
      if (node == 0 || joint == settings.joint) {
        continue;
      }
      if (node == own_node || has_joint[node]) {
        return false;
      }
      has_joint[node] = true;
    }
  }
  return true;
}

void StateReceiver::configure(const ModuleSettings& settings) {
  constexpr std::array first_identifier{canopen::identifier::state_frame, canopen::identifier::second_state};
  std::array<std::uint16_t, max_channels * max_joints> identifiers{};
  std::size_t count = 0;
  joints_ = {};
  for (unsigned channel = 0; channel < max_channels; ++channel) {
    for (unsigned joint = 0; joint < settings.joint_count; ++joint) {
      const std::uint8_t node = settings.nodes[channel][joint];
      if (node != 0 && joint_.kernel().needs_frame(joint, channel)) {
        joints_[channel][node] = static_cast<std::uint8_t>(joint + 1U);
        identifiers[count++] = static_cast<std::uint16_t>(first_identifier[channel] + node);
      }
    }
  }
  port_.listen({identifiers.data(), count});
}

void StateReceiver::stop() {
  joints_ = {};
  port_.listen({});
}

void StateReceiver::clear_reported_errors() {
  reported_length_ = {};
  reported_label_ = {};
  unknown_labels_ = 0;
}

void StateReceiver::receive(const CanFrame& frame, unsigned channel, std::uint8_t node, bool synchronised) {
  if (joints_[channel][node] == 0) {
    return;
  }
  const unsigned joint = joints_[channel][node] - 1U;
  const std::optional<StateFrame> state = canopen::decode_state(frame);
  if (!state) {
    if (!reported_length_.contains(joint)) {
      reported_length_.insert(joint);
      emergencies_.report(canopen::EmergencyCode::wrong_length, joint);
    }
    return;
  }
  // Distance of the label from the coming tick, plus one: 0 to 2, whether the module has computed its tick or not.
  const auto distance = static_cast<std::uint8_t>(state->label() - joint_.kernel().tick() + 1U);
  if (distance > 2) {
    ++unknown_labels_;
    if (synchronised && !reported_label_.contains(joint)) {
      reported_label_.insert(joint);
      emergencies_.report(canopen::EmergencyCode::unknown_label, joint);
    }
  }
  joint_.receive(joint, channel, *state);
}

}  // namespace proleg::firmware
