#pragma once

#include "firmware/module/bus_recovery.hpp"
#include "firmware/module/drive.hpp"
#include "firmware/module/host_watch.hpp"
#include "firmware/module/servo_monitor.hpp"
#include "firmware/module/state_receiver.hpp"
#include "firmware/module/sync_producer.hpp"

namespace proleg::firmware {

/// What a module consists of. Each part minds one thing; Module moves them by the events, DeviceObjects shows them to
/// the host.
struct Parts {
  Parts(const Board& board_as_built, const Ports& ports)
      : board(board_as_built),
        can(ports.can),
        outbox(ports.can),
        recovery(ports.can),
        drive(ports.servo),
        monitor(ports.sensors, (board_as_built.capabilities & canopen::measures_angle) != 0),
        contacts(ports.contacts) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  const Board board;
  CanPort& can;
  Outbox outbox;
  BusRecovery recovery;
  NetworkNode network{board, outbox};
  Emergencies emergencies{board, network, outbox};
  HostWatch host;
  Settings settings;
  JointKernel joint;
  StateReceiver neighbours{joint, emergencies, can};
  SyncProducer producer{outbox};
  Drive drive;
  ServoMonitor monitor;
  ContactPort& contacts;
};

}  // namespace proleg::firmware
