#include "firmware/module/motion_control.hpp"

#include "firmware/module/watches.hpp"

namespace proleg::firmware {
namespace {

using canopen::EmergencyCode;
using canopen::PowerState;

void send_state(Parts& parts) {
  const Kernel& kernel = parts.joint.kernel();
  const unsigned joint = parts.joint.joint();
  for (unsigned channel = 0; channel < kernel.channel_count(joint); ++channel) {
    parts.outbox.send_newest(canopen::encode_state(parts.identity.node, channel, kernel.frame(joint, channel)));
  }
}

/// Computes state 0 from the present parameters. Its frame is sent, so that all joints have it at tick 0.
void prepare_start(Parts& parts) {
  parts.joint.set_fault(parts.drive.power().state() == PowerState::fault);
  parts.joint.restart();
  parts.start.has_sent_state = true;
  send_state(parts);
}

void report_early_sync(Parts& parts, std::uint32_t early_us) {
  if (!parts.start.has_early_sync) {
    parts.start.has_early_sync = true;
    parts.emergencies.report(EmergencyCode::early_sync, early_us);
  }
}

/// Sends monitoring in the joint's tick of the period: the joints take turns, so that their frames do not come
/// together.
void send_monitoring(Parts& parts, std::uint32_t tick) {
  const std::uint32_t period = parts.joint.monitoring_period();
  if (tick % period == parts.joint.joint() % period) {
    const ServoMonitor& monitor = parts.monitor;
    parts.outbox.send_newest(
        encode(canopen::Monitoring{parts.identity.node, canopen::monitored_angle(monitor.angle()), monitor.current_ma(),
                                   monitor.temperature_c(), parts.emergencies.error_register()}));
  }
}

void compute(Parts& parts, Microseconds now, const SyncMeaning& meaning) {
  const Kernel& kernel = parts.joint.kernel();
  const std::uint32_t first_tick = kernel.tick();
  parts.joint.set_fault(parts.drive.power().state() == PowerState::fault);
  parts.joint.advance(meaning.missed, parts.contacts.read_contacts(), parts.monitor.current_ma());
  send_state(parts);
  read_servo(parts, now);
  send_monitoring(parts, kernel.tick() - 1U);
  parts.drive.update(now, true, true);  // before the tick, so that the first pulse can be that of this SYNC
  parts.drive.start_tick(now, kernel.tick() - 1U, kernel, parts.joint.limits());
  parts.emergencies.clear(Fault::sync_lost);
  if (meaning.joined) {
    parts.emergencies.report(EmergencyCode::rejoined, first_tick);
  }
}

}  // namespace

void start_gait(Parts& parts, bool together) {
  if (together && !parts.start.has_received_sync) {
    prepare_start(parts);
  }
}

void stop_gait(Parts& parts) {
  parts.keeper.lose();
  parts.start = {};
  if (parts.joint.active()) {
    parts.joint.restart();  // there is no tick yet: commits for any tick of the next start are in time
  }
}

void receive_tick(Parts& parts, const CanFrame& frame) {
  const std::optional<canopen::TickMessage> message = canopen::decode_tick(frame);
  if (!message || !parts.network.operational()) {
    return;
  }
  if (message->configuration_crc != parts.joint.configuration_crc()) {
    parts.keeper.lose();
    if (!parts.emergencies.is_raised(Fault::foreign_configuration)) {
      parts.emergencies.raise(Fault::foreign_configuration, message->configuration_crc);
    }
    return;
  }
  parts.emergencies.clear(Fault::foreign_configuration);
  const Kernel& kernel = parts.joint.kernel();
  if (!parts.keeper.announce(message->tick, kernel.tick())) {
    parts.emergencies.raise(Fault::sync_lost, kernel.tick());
  }
  if (message->tick == 0 && !parts.keeper.keeps_tick() && (kernel.tick() != 0 || !parts.start.has_sent_state)) {
    prepare_start(parts);
  }
}

void receive_sync(Parts& parts, Microseconds now, const CanFrame& frame) {
  const std::optional<std::uint8_t> counter = canopen::decode_sync(frame);
  if (!counter) {
    return;
  }
  parts.start.has_received_sync = true;
  if (!parts.network.operational()) {
    return;
  }
  const Kernel& kernel = parts.joint.kernel();
  if (parts.keeper.keeps_tick()) {
    if (const std::uint32_t early_us = parts.sync.early_us(now, kernel.configuration().tick_period_us); early_us != 0) {
      if (canopen::ticks_until_counter(kernel.tick(), *counter) != canopen::sync_counters - 1U) {
        report_early_sync(parts, early_us);
      }  // else the frame was received twice, which CAN allows
      return;
    }
  }
  const SyncMeaning meaning = parts.keeper.sync(*counter, kernel.tick());
  if (meaning.action != SyncMeaning::Action::none) {
    parts.sync.note_tick(now);
  } else if (!parts.keeper.keeps_tick()) {
    parts.sync.restart(now);
  }  // else the SYNC is that of the last tick
  if (meaning.lost) {
    parts.emergencies.raise(Fault::sync_lost, kernel.tick());
  }
  switch (meaning.action) {
    case SyncMeaning::Action::none:
      break;
    case SyncMeaning::Action::compute:
      compute(parts, now, meaning);
      break;
    case SyncMeaning::Action::join:
      parts.joint.join(meaning.tick + 1U);
      break;
  }
}

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
