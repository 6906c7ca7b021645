#include "firmware/module/network_control.hpp"

#include "firmware/module/motion_control.hpp"

namespace proleg::firmware {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;

/// Whether the joint is configured, and the communication objects of its configuration are set.
bool is_configured(Parts& parts) {
  if (!parts.joint.active()) {
    return false;
  }
  if (parts.must_restore_communication) {
    if (!StateReceiver::accepts(parts.settings, parts.identity.node) ||
        parts.settings.crc(parts.identity.node) != parts.joint.configuration_crc()) {
      return false;
    }
    parts.neighbours.configure(parts.settings);
    parts.must_restore_communication = false;
  }
  return true;
}

void enter_operational(Parts& parts, bool together) {
  if (!is_configured(parts)) {
    parts.emergencies.report(canopen::EmergencyCode::not_configured,
                             static_cast<std::uint32_t>(parts.joint.last_refusal()));
    return;
  }
  parts.network.enter(NmtState::operational);
  parts.neighbours.clear_reported_errors();
  parts.reported.has_wrong_command = false;
  start_gait(parts, together);
}

void leave_operational(Parts& parts, NmtState state) {
  parts.network.enter(state);
  parts.producer.stop();
  parts.drive.disable();
  stop_gait(parts);
}

}  // namespace

void change_state(Parts& parts, const canopen::NmtRequest& request) {
  switch (request.command) {
    case NmtCommand::start:
      if (!parts.network.has_collided() && !parts.network.operational()) {
        enter_operational(parts, request.node == 0);
      }
      return;
    case NmtCommand::stop:
      leave_operational(parts, NmtState::stopped);
      return;
    case NmtCommand::enter_pre_operational:
      if (!parts.network.has_collided()) {
        leave_operational(parts, NmtState::pre_operational);
      }
      return;
    default:
      return;
  }
}

void stop_after_collision(Parts& parts, std::uint16_t identifier) {
  if (parts.network.started() && parts.network.notice_collision(identifier) && parts.network.has_sent_boot_up()) {
    report_collision(parts);
  }
}

void report_collision(Parts& parts) {
  parts.emergencies.raise(Fault::identifier_collision, parts.network.collision());
  leave_operational(parts, NmtState::stopped);
}

}  // namespace proleg::firmware
