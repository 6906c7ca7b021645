#include "sim/hardware_loop/state_frame_monitor.hpp"

namespace proleg::sim {

StateFrameMonitor::StateFrameMonitor(const Scenario& scenario) : scenario_(scenario) {
  joint_of_node_.fill(no_joint);
  for (unsigned joint = 0; joint < scenario.modules.size(); ++joint) {
    joint_of_node_[scenario.modules[joint].node] = joint;
  }
}

void StateFrameMonitor::begin_tick(std::uint32_t tick) {
  sent_ = {};
  label_ = tick + 1;
}

void StateFrameMonitor::note(const Transmission& transmission) {
  const auto state = canopen::decode_state(transmission.frame);
  if (state && transmission.sender < scenario_.modules.size() &&
      transmission.frame.identifier == canopen::identifier::state_frame + scenario_.modules[transmission.sender].node &&
      state->label() == static_cast<std::uint8_t>(label_)) {
    sent_.insert(static_cast<unsigned>(transmission.sender));
  }
}

bool StateFrameMonitor::is_lost(const Losses& losses, const CanFrame& frame, std::size_t receiver) const {
  const auto state = canopen::decode_state(frame);
  const bool is_first = frame.identifier > canopen::identifier::state_frame &&
                        frame.identifier <= canopen::identifier::state_frame + canopen::max_node_id;
  const bool is_second = frame.identifier > canopen::identifier::second_state &&
                         frame.identifier <= canopen::identifier::second_state + canopen::max_node_id;
  if (!state || (!is_first && !is_second)) {
    return false;
  }
  const unsigned node = unsigned{frame.identifier} -
                        unsigned{is_first ? canopen::identifier::state_frame : canopen::identifier::second_state};
  const unsigned sender = joint_of_node_[node];
  if (sender == no_joint || receiver >= scenario_.modules.size() ||
      state->label() != static_cast<std::uint8_t>(label_)) {
    return false;
  }
  return losses.lost({label_, static_cast<std::uint8_t>(sender), static_cast<std::uint8_t>(is_second ? 1 : 0),
                      static_cast<std::uint8_t>(receiver)});
}

}  // namespace proleg::sim
