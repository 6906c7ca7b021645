#include "firmware/module/host_requests.hpp"

namespace proleg::firmware {

using canopen::EmergencyCode;

void receive_commit(Parts& parts, const CanFrame& frame) {
  const std::optional<canopen::CommitMessage> message = canopen::decode_commit(frame);
  if (!message || parts.network.state() == canopen::NmtState::stopped || !parts.joint.active() ||
      message->robot != parts.joint.robot_id()) {
    return;
  }
  const Status status = parts.joint.commit(message->transaction, message->tick);
  if (status == Status::ok) {
    parts.reported.commit.reset();
    return;
  }
  if (parts.reported.commit == message) {
    return;  // the host sends it three times, so this is a repetition
  }
  parts.reported.commit = message;
  if (status == Status::commit_in_the_past) {
    parts.emergencies.report(EmergencyCode::commit_too_late, message->tick);
  } else {
    parts.emergencies.report(EmergencyCode::commit_not_staged, message->transaction);
  }
}

void receive_command(Parts& parts, const CanFrame& frame) {
  const std::optional<canopen::Command> command = canopen::decode_command(frame);
  if (!command) {
    if (!parts.reported.has_wrong_command) {
      parts.reported.has_wrong_command = true;
      parts.emergencies.report(EmergencyCode::wrong_length, frame.identifier);
    }
    return;
  }
  parts.drive.power().command(command->controlword);
  // A value that is no joint angle is no target; SDO rejects it, too.
  if (canopen::check_range(canopen::object::target_position, static_cast<std::uint32_t>(command->target)) ==
      canopen::AbortCode::none) {
    parts.drive.set_target(command->target);
  }
}

}  // namespace proleg::firmware
