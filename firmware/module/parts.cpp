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
  outbox.reset();
  recovery.reset();
  network.start(now);
  emergencies.reset();
  host.set(canopen::object::host_heartbeat.default_value);
  reported = {};
  settings = {};
  joint.deactivate();
  joint.clear_refusal();
  neighbours.stop();
  neighbours.clear_reported_errors();
  keeper.lose();
  start = {};
  sync.stop();
  producer.stop();
  drive.reset();
  monitor.reset();
}

}  // namespace proleg::firmware
