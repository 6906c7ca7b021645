#include "firmware/module/watches.hpp"

namespace proleg::firmware {

using canopen::PowerState;

void leave_bus(Parts& parts, Microseconds now) {
  parts.recovery.bus_off(now);
  parts.outbox.close();
  parts.gateway.bus_off();
  parts.producer.bus_off(now);
  parts.drive.power().quick_stop();
}

void return_to_bus(Parts& parts, Microseconds now) {
  const std::uint32_t off_ms = parts.recovery.bus_back(now);
  parts.outbox.open();
  parts.gateway.bus_back();
  if (parts.network.has_sent_boot_up()) {
    parts.emergencies.raise(Fault::bus_off, off_ms);
  } else {
    parts.network.repeat_boot_up(now);
  }
}

void receive_heartbeat(Parts& parts, Microseconds now, const CanFrame& frame) {
  const std::optional<canopen::Heartbeat> heartbeat = canopen::decode_heartbeat(frame);
  if (!heartbeat) {
    return;
  }
  if (heartbeat->node == canopen::host_node) {
    parts.lease.renew(now);
  }
  if (parts.host.receive_heartbeat(now, heartbeat->node)) {
    parts.emergencies.clear(Fault::heartbeat_lost);
  }
}

namespace {

/// Raises or clears the fault of a condition of the hardware with which the servo must have no pulses.
void follow(Parts& parts, Fault fault, bool is_present) {
  if (!is_present) {
    parts.emergencies.clear(fault);
  } else if (!parts.emergencies.is_raised(fault)) {
    parts.drive.power().fault();
    parts.emergencies.raise(fault, 0);
  }
}

}  // namespace

void read_servo(Parts& parts, Microseconds now) {
  parts.monitor.read(now, parts.settings.tick_period_us);
  if (parts.monitor.over_current() && parts.drive.power().state() != PowerState::fault) {
    parts.drive.power().fault();
    parts.emergencies.raise(Fault::over_current, 0);
  }
  follow(parts, Fault::sensors_failed, parts.monitor.sensors_failed());
  follow(parts, Fault::over_temperature, parts.monitor.is_too_hot());
}

void end_supply_low(Parts& parts) {
  parts.is_supply_low = false;
  parts.emergencies.clear(Fault::supply_low);
}

void require_good_hardware(Parts& parts) {
  if (parts.emergencies.is_raised(Fault::sensors_failed) || parts.emergencies.is_raised(Fault::over_temperature)) {
    parts.drive.power().fault();
  }
  // Before the boot-up message the drive cannot be enabled, and EMCY would overtake the message.
  if (!parts.is_supply_low || !parts.network.has_sent_boot_up()) {
    return;
  }
  parts.drive.power().fault();
  if (!parts.emergencies.is_raised(Fault::supply_low)) {
    parts.emergencies.raise(Fault::supply_low, 0);
  }
}

void require_known_settings(Parts& parts) {
  if (!parts.board.has_newer()) {
    parts.emergencies.clear(Fault::newer_settings);
    return;
  }
  parts.drive.disable();
  if (parts.network.has_sent_boot_up() && !parts.emergencies.is_raised(Fault::newer_settings)) {
    parts.emergencies.raise(Fault::newer_settings, 0);
  }
}

void poll_bus(Parts& parts, Microseconds now) {
  if (parts.recovery.poll(now)) {
    parts.emergencies.clear(Fault::bus_off);
  }
}

void poll_host(Parts& parts, Microseconds now) {
  parts.lease.poll(now);
  if (parts.host.poll_timeout(now)) {
    parts.emergencies.raise(Fault::heartbeat_lost, parts.host.expected() >> 16U);
    parts.drive.power().quick_stop();
  }
}

void poll_sync(Parts& parts, Microseconds now) {
  if (parts.sync.poll_timeout(now)) {
    parts.keeper.lose();
    parts.emergencies.raise(Fault::sync_lost, parts.joint.kernel().tick());
    parts.drive.power().quick_stop();
  }
}

void clear_over_current(Parts& parts) {
  if (parts.drive.power().state() != PowerState::fault && parts.emergencies.is_raised(Fault::over_current)) {
    parts.monitor.clear_over_current();
    parts.emergencies.clear(Fault::over_current);
  }
}

void update_drive(Parts& parts, Microseconds now) {
  const bool operational = parts.network.operational();
  // All modules were started together, and no SYNC was received since: the joint is in state 0.
  if (operational && parts.start.has_sent_state && !parts.start.has_received_sync) {
    const Drive::StartPose start{parts.monitor.new_angle(), parts.joint.kernel(), parts.joint.limits()};
    parts.drive.update(now, true, false, &start);
  } else {
    parts.drive.update(now, operational, parts.keeper.synchronised());
  }
}

void update_watches(Parts& parts, Microseconds now) {
  const bool is_enabled = parts.drive.power().state() == PowerState::operation_enabled;
  parts.host.update(now, is_enabled);
  // A joint that ramps in has no tick yet. If its host stops, the heartbeat is missing; if none is expected, SYNC is
  // missing.
  const bool waits_for_sync = is_enabled && !(parts.drive.is_ramping_in() && parts.host.expects_heartbeat());
  parts.sync.update(now, parts.network.operational() && (parts.keeper.keeps_tick() || waits_for_sync));
}

}  // namespace proleg::firmware
