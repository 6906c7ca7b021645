#include "firmware/module/parts.hpp"

namespace proleg::firmware {

Parts::Parts(const ModuleIdentity& module_identity, const Ports& ports)
    : identity(module_identity),
      can(ports.can),
      board(ports.flash),
      outbox(ports.can),
      recovery(ports.can),
      gateway(identity, ports),
      drive(ports.servo),
      monitor(ports.sensors, (module_identity.capabilities & canopen::has_no_current_sensor) == 0),
      contacts(ports.contacts),
      update(identity, ports) {}

void Parts::load() {
  board.load();
  lss.power_on(board.stored().node);
  gateway.power_on();
}

void Parts::reset(Microseconds now) {
  joint.deactivate();
  board.reset();
  gateway.set_role(board.stored().is_gateway);
  identity.capabilities &= ~canopen::measures_angle;
  identity.capabilities |= board.stored().has_feedback ? canopen::measures_angle : 0U;
  reset_communication(now);
  emergencies.reset();
  settings = {};
  joint.clear_refusal();
  drive.reset();
  lease.reset();
  monitor.reset(board.stored());
}

void Parts::reset_communication(Microseconds now) {
  lss.reset();
  if (identity.node != lss.pending_node()) {
    joint.deactivate();  // its configuration contains the node
  }
  identity.node = lss.pending_node();
  can.set_node(identity.node);
  outbox.reset();
  recovery.reset();
  network.start(now);
  emergencies.reset_communication();
  expect_heartbeat(canopen::object::host_heartbeat.default_value);
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
  drive.disable();
}

void Parts::expect_heartbeat(std::uint32_t value) {
  host.set(value);
  pass_heartbeats();
}

}  // namespace proleg::firmware
