#pragma once

#include "firmware/module/board_store.hpp"
#include "firmware/module/bus_recovery.hpp"
#include "firmware/module/drive.hpp"
#include "firmware/module/gateway.hpp"
#include "firmware/module/host_watch.hpp"
#include "firmware/module/lease.hpp"
#include "firmware/module/loss_counter.hpp"
#include "firmware/module/program_update.hpp"
#include "firmware/module/servo_monitor.hpp"
#include "firmware/module/state_receiver.hpp"
#include "firmware/module/sync_producer.hpp"
#include "firmware/module/sync_watch.hpp"
#include "firmware/module/tick_keeper.hpp"
#include "shared/canopen/lss_slave.hpp"

namespace proleg::firmware {

/// How far the start of the gait is.
struct GaitStart {
  bool has_received_sync = false;  ///< since Operational was left: the robot moves already
  bool has_sent_state = false;     ///< the frame of state 0, since Operational was entered
  bool has_early_sync = false;     ///< reported, since Operational was left
};

/// Errors in the host's requests that were reported, so that a repetition is not.
struct ReportedRequests {
  bool has_wrong_command = false;                  ///< since Operational was entered
  std::optional<canopen::CommitMessage> commit{};  ///< the last one that was rejected
};

/// What a module consists of: the whole state of the program, one piece in each part. The functions over it are in
/// network_control.hpp, tick_control.hpp, watches.hpp and host_requests.hpp, a job in each; Module calls them.
struct Parts {
  Parts(const ModuleIdentity& module_identity, const Ports& ports);
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  /// Reads the settings of the board. The gateway is off until reset().
  void load();
  /// As after power on: application and communication (NMT reset node).
  void reset(Microseconds now);
  /// The communication objects, 0x1000 to 0x1FFF, as after power on, and the servo without power. The application
  /// remains as it is: what the module knows of robot, gait and servo (NMT reset communication). A node id that LSS has
  /// configured comes into use.
  void reset_communication(Microseconds now);

  ModuleIdentity identity;
  CanPort& can;
  BoardStore board;
  canopen::LssSlave lss;
  Outbox outbox;
  BusRecovery recovery;
  NetworkNode network{identity, outbox};
  Gateway gateway;
  Emergencies emergencies{identity, network, outbox};
  HostWatch host;
  ReportedRequests reported;
  GaitStart start;  // fills a gap before the settings
  /// Since the reset of communication; the tick period and the identifiers of the state frames are the defaults.
  Lease lease;
  bool must_restore_communication = false;
  ModuleSettings settings;
  JointKernel joint;
  StateReceiver neighbours{joint, emergencies, can};
  TickKeeper keeper;
  SyncWatch sync;
  SyncProducer producer{outbox};
  Drive drive;
  ServoMonitor monitor;
  LossCounter losses;          ///< a reset of the node does not change it
  bool is_supply_low = false;  ///< a reset of the node does not change it
  ContactPort& contacts;
  ProgramUpdate update;  ///< a reset of the node does not change it
};

}  // namespace proleg::firmware
