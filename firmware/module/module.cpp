#include "firmware/module/module.hpp"

namespace proleg::firmware {

namespace identifier = canopen::identifier;
using canopen::EmergencyCode;
using canopen::NmtCommand;
using canopen::NmtState;

namespace {

Microseconds earlier(Microseconds a, Microseconds b) { return a < b ? a : b; }

}  // namespace

Module::Module(const Board& board, const Ports& ports) : parts_(board, ports), objects_(parts_) {}

void Module::power_on(Microseconds now) {
  reset(now);
  reset_cause_told_ = false;
  settle(now);
}

/// What power_on() and the host's reset have in common.
void Module::reset(Microseconds now) {
  parts_.outbox.reset();
  parts_.recovery.reset();
  parts_.network.start(now);
  parts_.emergencies.reset();
  parts_.host.set(canopen::object::host_heartbeat.default_value);
  parts_.settings = {};
  parts_.joint.deactivate();
  parts_.neighbours.stop();
  parts_.neighbours.forget_complaints();
  parts_.producer.stop();
  parts_.drive.reset();
  parts_.monitor.reset();
  objects_.reset();
  keeper_.lose();
  boot_up_sent_ = false;
  collided_ = false;
  sync_heard_ = false;
  start_sent_ = false;
  wrong_command_ = false;
  refused_commit_.reset();
  sync_silence_ends_ = never;
}

// Events.

void Module::receive(Microseconds now, const CanFrame& frame) {
  if (receive_state(frame)) {
    return;
  }
  if (is_own(frame.identifier)) {
    collide(frame.identifier);
  } else if (state() != NmtState::boot_up) {
    dispatch(now, frame);
  }
  settle(now);
}

/// State frames are most of the traffic, and nothing follows from one before the next SYNC. False: it is none, or a
/// stranger's with the module's own identifier.
bool Module::receive_state(const CanFrame& frame) {
  constexpr unsigned node_bits = 0x7F;
  const unsigned function = frame.identifier & ~node_bits;
  const auto node = static_cast<std::uint8_t>(frame.identifier & node_bits);
  if ((function != identifier::state_frame && function != identifier::second_state) || node == parts_.board.node) {
    return false;
  }
  if (parts_.network.operational()) {
    parts_.neighbours.receive(frame, function == identifier::state_frame ? 0 : 1, node, keeper_.synchronised());
  }
  return true;
}

void Module::transmitted(Microseconds now, const CanFrame& frame) {
  parts_.outbox.sent();
  parts_.producer.transmitted(now, frame);
  if (!boot_up_sent_ && frame.identifier == identifier::heartbeat + parts_.board.node) {
    boot_up_sent_ = true;
    tell_reset_cause();
  }
  // A controller does not hear itself: these count for the module that sends them as for all others.
  if (frame.identifier == identifier::sync || frame.identifier == identifier::tick) {
    receive(now, frame);
  } else {
    find_deadlines();
  }
}

void Module::bus_off(Microseconds now) {
  if (!parts_.recovery.is_off()) {
    parts_.recovery.bus_off(now);
    parts_.outbox.close();
    parts_.producer.bus_off(now);
    parts_.drive.power().quick_stop();
    settle(now);
  }
}

void Module::bus_back(Microseconds now) {
  if (parts_.recovery.is_off()) {
    const std::uint32_t off_ms = parts_.recovery.bus_back(now);
    parts_.outbox.open();
    if (boot_up_sent_) {
      parts_.emergencies.raise(Fault::bus_off, off_ms);
    } else {
      parts_.network.repeat_boot_up(now);  // nobody has heard of the module
    }
    settle(now);
  }
}

void Module::poll(Microseconds now) {
  if (now >= deadline_of_parts_) {
    poll_parts(now);
  }
  parts_.drive.poll(now);  // last: a stop that is due comes before a pulse that is due
  next_deadline_ = earlier(deadline_of_parts_, parts_.drive.next_deadline());
}

/// All but the servo, which is due far more often.
void Module::poll_parts(Microseconds now) {
  if (parts_.recovery.poll(now)) {
    parts_.emergencies.clear(Fault::bus_off);
  }
  const bool booting = state() == NmtState::boot_up;
  parts_.network.poll(now);
  if (now >= parts_.monitor.next_deadline() || (booting && state() != NmtState::boot_up)) {
    read_servo(now);
  }
  watch_host(now);
  watch_sync(now);
  parts_.producer.poll(now);
  settle(now);
}

/// When something is due next, after whatever may have changed that.
void Module::find_deadlines() {
  deadline_of_parts_ = sync_silence_ends_;
  for (const Microseconds deadline :
       {parts_.recovery.next_deadline(), parts_.network.next_deadline(), parts_.host.next_deadline(),
        parts_.producer.next_deadline(), parts_.monitor.next_deadline()}) {
    deadline_of_parts_ = earlier(deadline_of_parts_, deadline);
  }
  next_deadline_ = earlier(deadline_of_parts_, parts_.drive.next_deadline());
}

/// Whether only this module may send on an identifier.
bool Module::is_own(std::uint16_t identifier) const {
  constexpr unsigned node_bits = 0x7F;
  if ((identifier & node_bits) != parts_.board.node) {
    return false;
  }
  switch (identifier & ~node_bits) {
    case identifier::emergency:
    case identifier::state_frame:
    case identifier::second_state:
    case identifier::monitoring:
    case identifier::sdo_answer:
    case identifier::heartbeat:
      return true;
    default:
      return false;
  }
}

void Module::dispatch(Microseconds now, const CanFrame& frame) {
  constexpr unsigned node_bits = 0x7F;
  const auto node = static_cast<std::uint8_t>(frame.identifier & node_bits);
  const bool stopped = state() == NmtState::stopped;
  switch (frame.identifier) {
    case identifier::nmt:
      on_network_command(now, frame);
      return;
    case identifier::sync:
      on_sync(now, frame);
      return;
    case identifier::tick:
      on_tick(frame);
      return;
    case identifier::commit:
      on_commit(frame);
      return;
    default:
      break;
  }
  switch (frame.identifier & ~node_bits) {
    case identifier::command:
      if (node == parts_.board.node && parts_.network.operational()) {
        on_command(frame);
      }
      return;
    case identifier::sdo_request:
      if (node == parts_.board.node && !stopped) {
        objects_.serve(now, frame);
      }
      return;
    case identifier::heartbeat:
      on_heartbeat(now, frame);
      return;
    default:
      return;
  }
}

void Module::collide(std::uint16_t identifier) {
  if (collided_ || !parts_.network.started()) {
    return;
  }
  collided_ = true;
  parts_.emergencies.raise(Fault::identifier_collision, identifier);
  leave_operational(NmtState::stopped);
}

/// Once, if the program did not end as it should. When the boot-up message has gone: EMCY would overtake it.
void Module::tell_reset_cause() {
  if (reset_cause_told_) {
    return;
  }
  reset_cause_told_ = true;
  if (parts_.board.reset_cause == ResetCause::watchdog) {
    parts_.emergencies.report(EmergencyCode::watchdog_reset, parts_.board.reset_detail);
  } else if (parts_.board.reset_cause == ResetCause::fault) {
    parts_.emergencies.report(EmergencyCode::software_fault, parts_.board.reset_detail);
  }
}

// Network management.

void Module::on_network_command(Microseconds now, const CanFrame& frame) {
  const std::optional<canopen::NmtRequest> request = canopen::decode_nmt(frame);
  if (!request || (request->node != 0 && request->node != parts_.board.node)) {
    return;
  }
  switch (request->command) {
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      reset(now);
      return;
    case NmtCommand::start:
      if (!collided_ && !parts_.network.operational()) {
        enter_operational(request->node == 0);
      }
      return;
    case NmtCommand::stop:
      leave_operational(NmtState::stopped);
      return;
    case NmtCommand::enter_pre_operational:
      if (!collided_) {
        leave_operational(NmtState::pre_operational);
      }
      return;
  }
}

/// together: all modules were started, so that tick 0 is to come. One that is started alone joins a robot that moves.
void Module::enter_operational(bool together) {
  if (!parts_.joint.active()) {
    parts_.emergencies.report(EmergencyCode::not_configured, static_cast<std::uint32_t>(objects_.refusal()));
    return;
  }
  parts_.network.enter(NmtState::operational);
  parts_.neighbours.forget_complaints();
  wrong_command_ = false;
  if (together && !sync_heard_) {
    prepare_start();
  }
}

void Module::leave_operational(NmtState state) {
  parts_.network.enter(state);
  parts_.producer.stop();
  keeper_.lose();
  sync_heard_ = false;
  start_sent_ = false;
  if (parts_.joint.active()) {
    parts_.joint.restart();  // no tick yet: commits for any tick of the next start are in time
  }
}

/// State 0, as the parameters have it by now, and everybody knows it.
void Module::prepare_start() {
  parts_.joint.set_fault(power() == canopen::PowerState::fault);
  parts_.joint.restart();
  start_sent_ = true;
  send_state();
}

void Module::on_heartbeat(Microseconds now, const CanFrame& frame) {
  const std::optional<canopen::Heartbeat> heartbeat = canopen::decode_heartbeat(frame);
  if (!heartbeat) {
    return;
  }
  parts_.host.heard(now, heartbeat->node);
  if (parts_.host.present()) {
    parts_.emergencies.clear(Fault::heartbeat_lost);
  }
}

void Module::watch_host(Microseconds now) {
  if (parts_.host.missed(now)) {
    parts_.emergencies.raise(Fault::heartbeat_lost, parts_.host.expected() >> 16U);
    parts_.drive.power().quick_stop();
  }
}

// The tick.

void Module::on_tick(const CanFrame& frame) {
  const std::optional<canopen::TickMessage> message = canopen::decode_tick(frame);
  if (!message || !parts_.network.operational()) {
    return;
  }
  if (message->configuration_crc != parts_.joint.configuration_crc()) {
    keeper_.lose();
    if (!parts_.emergencies.is_raised(Fault::foreign_configuration)) {
      parts_.emergencies.raise(Fault::foreign_configuration, message->configuration_crc);
    }
    return;
  }
  parts_.emergencies.clear(Fault::foreign_configuration);
  if (!keeper_.announce(message->tick, kernel().tick())) {
    parts_.emergencies.raise(Fault::sync_lost, kernel().tick());
  }
  if (message->tick == 0 && !keeper_.keeps_tick() && (kernel().tick() != 0 || !start_sent_)) {
    prepare_start();
  }
}

void Module::on_sync(Microseconds now, const CanFrame& frame) {
  const std::optional<std::uint8_t> counter = canopen::decode_sync(frame);
  if (!counter) {
    return;
  }
  sync_heard_ = true;
  if (!parts_.network.operational()) {
    return;
  }
  if (sync_silence_ends_ != never) {
    sync_silence_ends_ = now + longest_sync_silence_us;
  }
  const SyncMeaning meaning = keeper_.sync(*counter, kernel().tick());
  if (meaning.lost) {
    parts_.emergencies.raise(Fault::sync_lost, kernel().tick());
  }
  switch (meaning.action) {
    case SyncMeaning::Action::none:
      break;
    case SyncMeaning::Action::compute:
      compute(now, meaning);
      break;
    case SyncMeaning::Action::join:
      parts_.joint.join(meaning.tick + 1U);
      break;
  }
}

void Module::compute(Microseconds now, const SyncMeaning& meaning) {
  const std::uint32_t first_tick = kernel().tick();
  parts_.joint.set_fault(power() == canopen::PowerState::fault);
  parts_.joint.advance(meaning.missed, parts_.contacts.read());
  send_state();
  read_servo(now);
  send_monitoring(kernel().tick() - 1U);
  parts_.drive.update(now, true, true);  // so that the first pulse can be that of this SYNC
  parts_.drive.start_tick(now, kernel().tick() - 1U, kernel(), parts_.joint.limits());
  parts_.emergencies.clear(Fault::sync_lost);
  if (meaning.joined) {
    parts_.emergencies.report(EmergencyCode::rejoined, first_tick);
  }
}

void Module::send_state() {
  const unsigned joint = parts_.joint.joint();
  for (unsigned channel = 0; channel < kernel().channel_count(joint); ++channel) {
    parts_.outbox.send(canopen::encode_state(parts_.board.node, channel, kernel().frame(joint, channel)));
  }
}

/// The joints take turns, so that their frames do not come all at once.
void Module::send_monitoring(std::uint32_t tick) {
  const std::uint32_t period = parts_.joint.monitoring_period();
  if (tick % period == parts_.joint.joint() % period) {
    const ServoMonitor& monitor = parts_.monitor;
    parts_.outbox.send(
        encode(canopen::Monitoring{parts_.board.node, canopen::monitored_angle(monitor.angle()), monitor.current_ma(),
                                   monitor.temperature_c(), parts_.emergencies.error_register()}));
  }
}

void Module::read_servo(Microseconds now) {
  parts_.monitor.read(now, parts_.settings.tick_period_us);
  if (parts_.monitor.over_current() && power() != canopen::PowerState::fault) {
    parts_.drive.power().fault();
    parts_.emergencies.raise(Fault::over_current, 0);
  }
}

void Module::watch_sync(Microseconds now) {
  if (now < sync_silence_ends_) {
    return;
  }
  sync_silence_ends_ = never;
  keeper_.lose();
  parts_.emergencies.raise(Fault::sync_lost, kernel().tick());
  parts_.drive.power().quick_stop();
}

void Module::settle(Microseconds now) {
  if (power() != canopen::PowerState::fault && parts_.emergencies.is_raised(Fault::over_current)) {
    parts_.monitor.forget_current();
    parts_.emergencies.clear(Fault::over_current);
  }
  parts_.drive.update(now, parts_.network.operational(), keeper_.synchronised());
  const bool watches =
      parts_.network.operational() && (keeper_.keeps_tick() || power() == canopen::PowerState::operation_enabled);
  if (!watches) {
    sync_silence_ends_ = never;
  } else if (sync_silence_ends_ == never) {
    sync_silence_ends_ = now + longest_sync_silence_us;
  }
  find_deadlines();
}

// What the host asks for in flight.

void Module::on_commit(const CanFrame& frame) {
  const std::optional<canopen::CommitMessage> message = canopen::decode_commit(frame);
  if (!message || state() == NmtState::stopped || !parts_.joint.active() || message->robot != parts_.joint.robot_id()) {
    return;
  }
  const Status status = parts_.joint.commit(message->transaction, message->tick);
  if (status == Status::ok) {
    refused_commit_.reset();
    return;
  }
  if (refused_commit_ == message) {
    return;  // it is sent three times
  }
  refused_commit_ = message;
  if (status == Status::commit_in_the_past) {
    parts_.emergencies.report(EmergencyCode::commit_too_late, message->tick);
  } else {
    parts_.emergencies.report(EmergencyCode::commit_not_staged, message->transaction);
  }
}

void Module::on_command(const CanFrame& frame) {
  const std::optional<canopen::Command> command = canopen::decode_command(frame);
  if (!command) {
    if (!wrong_command_) {
      wrong_command_ = true;
      parts_.emergencies.report(EmergencyCode::wrong_length, frame.identifier);
    }
    return;
  }
  parts_.drive.power().command(command->controlword);
  // As by SDO: what is no joint angle is no target.
  if (canopen::check_range(canopen::object::target_position, static_cast<std::uint32_t>(command->target)) ==
      canopen::AbortCode::none) {
    parts_.drive.set_target(command->target);
  }
}

}  // namespace proleg::firmware
