#pragma once

#include "firmware/module/drive.hpp"
#include "firmware/module/host_watch.hpp"
#include "firmware/module/state_receiver.hpp"
#include "firmware/module/sync_producer.hpp"

namespace proleg::firmware {

/// What a module consists of. Each part minds one thing; Module moves them by the events, DeviceObjects shows them to
/// the host.
struct Parts {
  Parts(const Board& board_as_built, const Ports& ports)
      : board(board_as_built), outbox(ports.can), drive(ports.servo), contacts(ports.contacts) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  const Board board;
  Outbox outbox;
  NetworkNode network{board, outbox};
  Emergencies emergencies{board, network, outbox};
  HostWatch host;
  Settings settings;
  JointKernel joint;
  StateReceiver neighbours{joint, emergencies};
  SyncProducer producer{outbox};
  Drive drive;
  ContactPort& contacts;
};

}  // namespace proleg::firmware
