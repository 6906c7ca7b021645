#include "firmware/module/parts.hpp"

namespace proleg::firmware {

Parts::Parts(const ModuleIdentity& module_identity, const Ports& ports)
    : identity(module_identity),
      can(ports.can),
      outbox(ports.can),
      recovery(ports.can),
      drive(ports.servo),
      monitor(ports.sensors, (module_identity.capabilities & canopen::measures_angle) != 0),
      contacts(ports.contacts) {}

void Parts::reset(Microseconds now) {
  joint.deactivate();
  reset_communication(now);
  emergencies.reset();
  settings = {};
  joint.clear_refusal();
  drive.reset();
  monitor.reset();
}

void Parts::reset_communication(Microseconds now) {
  outbox.reset();
  recovery.reset();
  network.start(now);
  emergencies.reset_communication();
  host.set(canopen::object::host_heartbeat.default_value);
  reported = {};
  settings.tick_period_us = canopen::object::tick_period.default_value;
  for (auto& channel : settings.nodes) {
    channel.fill(0);
  }
  must_restore_communication = true;
  neighbours.stop();
  neighbours.clear_reported_errors();
  keeper.lose();
  start = {};
  sync.stop();
  producer.stop();
  if (joint.active()) {
    joint.restart();
  }
  constexpr std::uint16_t disable_voltage = 0;
  drive.power().command(disable_voltage);
}

}  // namespace proleg::firmware
