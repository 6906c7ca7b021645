#include "firmware/module/module.hpp"

#include <algorithm>

#include "firmware/module/board_control.hpp"
#include "firmware/module/motion_control.hpp"
#include "firmware/module/network_control.hpp"
#include "firmware/module/watches.hpp"

namespace proleg::firmware {

namespace identifier = canopen::identifier;
using canopen::NmtCommand;
using canopen::NmtState;

Module::Module(const ModuleIdentity& identity, const Ports& ports) : parts_(identity, ports) {}

void Module::power_on(Microseconds now) {
  parts_.load();
  parts_.update.power_on(now);
  parts_.reset(now);
  objects_.reset();
  parts_.emergencies.power_on();
  finish_event(now);
}

void Module::receive(Microseconds now, const CanFrame& frame) {
  parts_.update.received();
  handle(now, frame);
  parts_.gateway.pass(now, frame);
}

/// Handles a frame that the module must receive, of another node or of its own.
void Module::handle(Microseconds now, const CanFrame& frame) {
  if (receive_state(frame)) {
    return;
  }
  if (frame.identifier == broadcast::host_identifier) {
    receive_update(now, frame);
    return;
  }
  if (frame.identifier == identifier::lss_request) {
    receive_lss(now, frame);
  } else if (identifier::node_of(frame.identifier) == parts_.identity.node &&
             identifier::has_one_sender(frame.identifier)) {
    stop_after_collision(parts_, frame.identifier);
  } else if (state() != NmtState::boot_up) {
    dispatch(now, frame);
  }
  finish_event(now);
}

/// Handles a state frame; false if it is no state frame, or has the module's own identifier. State frames are most of
/// the traffic, and change nothing before the next SYNC.
bool Module::receive_state(const CanFrame& frame) {
  const std::uint16_t base = identifier::base_of(frame.identifier);
  const std::uint8_t node = identifier::node_of(frame.identifier);
  if ((base != identifier::state_frame && base != identifier::second_state) || node == parts_.identity.node) {
    return false;
  }
  if (parts_.network.operational()) {
    parts_.neighbours.receive(frame, base == identifier::state_frame ? 0 : 1, node, synchronised());
  }
  return true;
}

void Module::dispatch(Microseconds now, const CanFrame& frame) {
  const std::uint8_t node = identifier::node_of(frame.identifier);
  const bool stopped = state() == NmtState::stopped;
  switch (frame.identifier) {
    case identifier::nmt:
      receive_network_command(now, frame);
      return;
    case identifier::sync:
      receive_sync(parts_, now, frame);
      return;
    case identifier::tick:
      receive_tick(parts_, frame);
      return;
    case identifier::commit:
      receive_commit(parts_, frame);
      return;
    default:
      break;
  }
  switch (identifier::base_of(frame.identifier)) {
    case identifier::command:
      if (node == parts_.identity.node && parts_.network.operational()) {
        receive_command(parts_, frame);
      }
      return;
    case identifier::sdo_request:
      if (node == parts_.identity.node && !stopped) {
        objects_.serve(now, frame);
      }
      return;
    case identifier::heartbeat:
      receive_heartbeat(parts_, now, frame);
      return;
    default:
      return;
  }
}

/// Handles frames of a broadcast of an image. There are thousands in a second, and they change nothing else.
void Module::receive_update(Microseconds now, const CanFrame& frame) {
  const bool may_restart = may_write_flash(parts_) && !parts_.is_supply_low;
  const ProgramUpdate::Conditions conditions{parts_.identity.node, may_restart, parts_.gateway.is_active(),
                                             parts_.board.has_newer()};
  if (const std::optional<CanFrame> answer = parts_.update.receive(now, frame, conditions)) {
    parts_.outbox.send(*answer);
  }
  find_deadlines();
}

void Module::receive_lss(Microseconds now, const CanFrame& frame) {
  if (state() == NmtState::boot_up && !parts_.network.waits_for_node()) {
    return;
  }
  if (const std::optional<CanFrame> answer = serve_lss(parts_, frame)) {
    parts_.outbox.send(*answer);
  }
  // CiA 305: a slave without a node id starts its communication when it has got one and leaves the configuration.
  if (parts_.network.waits_for_node() && parts_.lss.state() == canopen::lss::State::waiting &&
      parts_.lss.pending_node() != 0) {
    parts_.reset(now);
    objects_.reset();
  }
}

void Module::receive_network_command(Microseconds now, const CanFrame& frame) {
  const std::optional<canopen::NmtRequest> request = canopen::decode_nmt(frame);
  if (!request || (request->node != 0 && request->node != parts_.identity.node)) {
    return;
  }
  switch (request->command) {
    case NmtCommand::reset_node:
      parts_.reset(now);
      objects_.reset();
      return;
    case NmtCommand::reset_communication:
      parts_.reset_communication(now);
      objects_.reset();
      return;
    default:
      change_state(parts_, *request);
      return;
  }
}

void Module::transmitted(Microseconds now, const CanFrame& frame) {
  parts_.outbox.sent();
  parts_.update.transmitted();
  objects_.send_segments(now);
  if (parts_.gateway.confirm(now, frame)) {
    parts_.update.received();
    handle(now, frame);
    find_deadlines();
    return;
  }
  parts_.producer.transmitted(now, frame);
  if (parts_.network.confirm_boot_up(frame)) {
    parts_.emergencies.report_reset_cause();
    if (parts_.network.has_collided()) {
      report_collision(parts_);
      finish_event(now);
    }
    require_good_hardware(parts_);
    require_known_settings(parts_);
  }
  // A controller does not receive its own frames. SYNC and TICK count for the module that sends them as for all others.
  if (frame.identifier == identifier::sync || frame.identifier == identifier::tick) {
    handle(now, frame);
  } else {
    find_deadlines();
  }
  parts_.gateway.pass(now, frame);
}

bool Module::serve_line(Microseconds now) {
  return parts_.gateway.serve(now, {!parts_.outbox.is_empty(), parts_.network.operational()});
}

void Module::bus_off(Microseconds now) {
  if (!is_bus_off()) {
    objects_.reset();
    parts_.update.bus_was_lost();
    leave_bus(parts_, now);
    finish_event(now);
  }
}

void Module::bus_back(Microseconds now) {
  if (is_bus_off()) {
    return_to_bus(parts_, now);
    finish_event(now);
  }
}

void Module::frames_lost(Microseconds now, std::uint32_t count) {
  parts_.gateway.frames_lost();
  parts_.update.bus_was_lost();
  if (parts_.losses.add(now, count) && parts_.network.has_sent_boot_up()) {
    parts_.emergencies.report(canopen::EmergencyCode::frames_lost, count);
  }
}

void Module::supply_low(Microseconds now) {
  parts_.is_supply_low = true;
  finish_event(now);
}

void Module::supply_good(Microseconds now) {
  end_supply_low(parts_);
  finish_event(now);
}

void Module::poll(Microseconds now) {
  if (now >= deadline_of_parts_) {
    poll_parts(now);
  }
  parts_.drive.poll(now);  // comes last: a stop that is due comes before a pulse that is due
  next_deadline_ = std::min(deadline_of_parts_, parts_.drive.next_deadline());
  serve_line(now);
}

/// Polls all parts but the servo, which is due far more often.
void Module::poll_parts(Microseconds now) {
  poll_bus(parts_, now);
  const bool has_booted = parts_.network.poll(now);
  if (has_booted || now >= parts_.monitor.next_deadline()) {
    read_servo(parts_, now);
  }
  poll_host(parts_, now);
  poll_sync(parts_, now);
  parts_.producer.poll(now);
  const bool was_on_trial = parts_.update.is_on_trial();
  parts_.update.poll(now, may_write_flash(parts_) && !parts_.is_supply_low);
  if (was_on_trial && !parts_.update.is_on_trial()) {
    parts_.pass_heartbeats();
  }
  objects_.poll(now);
  finish_event(now);
}

/// Derives the servo's power and the deadlines from the state after the event.
void Module::finish_event(Microseconds now) {
  if (state() == NmtState::stopped) {
    objects_.reset();  // a stopped node has no SDO (CiA 301, table 37)
  }
  clear_over_current(parts_);
  require_good_hardware(parts_);
  require_known_settings(parts_);
  update_drive(parts_, now);
  update_watches(parts_, now);
  find_deadlines();
}

void Module::find_deadlines() {
  const Microseconds watches = std::min(std::min(parts_.recovery.next_deadline(), parts_.host.next_deadline()),
                                        std::min(parts_.sync.next_deadline(), parts_.monitor.next_deadline()));
  const Microseconds services = std::min(std::min(parts_.network.next_deadline(), parts_.producer.next_deadline()),
                                         std::min(objects_.next_deadline(), parts_.lease.next_deadline()));
  deadline_of_parts_ = std::min(std::min(watches, services), parts_.update.next_deadline());
  next_deadline_ = std::min(deadline_of_parts_, parts_.drive.next_deadline());
}

}  // namespace proleg::firmware
