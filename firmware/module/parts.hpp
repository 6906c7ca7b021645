#pragma once

#include "firmware/module/board_record.hpp"
#include "firmware/module/drive.hpp"
#include "firmware/module/gateway.hpp"
#include "firmware/module/program_update.hpp"
#include "firmware/module/servo_monitor.hpp"
#include "firmware/module/state_receiver.hpp"
#include "firmware/module/sync.hpp"
#include "firmware/module/timeouts.hpp"
#include "shared/can/can_port.hpp"
#include "shared/canopen/lss_slave.hpp"

namespace proleg::firmware {

/// Counts received frames that were lost, and decides which losses are reported: on a bus that is too busy, reports
/// would cause more losses.
class LossCounter {
 public:
  static constexpr Microseconds pause_us = 1'000'000;

  /// count: losses since the start. Returns whether to report it: once a second at most.
  [[nodiscard]] bool add(Microseconds now, std::uint32_t count) {
    count_ = count;
    if (now < next_report_) {
      return false;
    }
    next_report_ = now + pause_us;
    return true;
  }
  [[nodiscard]] std::uint32_t count() const { return count_; }

 private:
  std::uint32_t count_ = 0;
  Microseconds next_report_ = 0;
};

/// Progress of the start of the gait.
struct GaitStart {
  bool has_received_sync = false;  ///< SYNC was received since Operational was left: the robot moves already
  bool has_sent_state = false;     ///< the frame of state 0 was sent since Operational was entered
  bool has_early_sync = false;     ///< an early SYNC was reported since Operational was left
};

/// Errors in requests of the host that were reported, so that repetitions are not reported.
struct ReportedRequests {
  bool has_wrong_command = false;                  ///< a wrong command was reported since Operational was entered
  std::optional<canopen::CommitMessage> commit{};  ///< the last one that was rejected
};

/// The parts of a module: together they are the whole state of the program. Functions on them are in board_control.hpp,
/// motion_control.hpp, network_control.hpp and watches.hpp; Module calls them.
struct Parts {
  Parts(const ModuleIdentity& module_identity, const Ports& ports);
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  /// Reads the settings of the board. The gateway is off until reset().
  void load();
  /// Resets application and communication to the state after power-on (NMT reset node).
  void reset(Microseconds now);
  /// Resets the communication objects, 0x1000 to 0x1FFF, to the state after power-on, and takes the servo's power (NMT
  /// reset communication). The application remains as it is: the state of robot, gait and servo. A node id that
  /// LSS has configured takes effect.
  void reset_communication(Microseconds now);
  /// Sets the value of 0x1016 (HostWatch::set), and has the controller pass the heartbeat that it names.
  void expect_heartbeat(std::uint32_t value);
  /// Has the controller pass the heartbeats that the module needs now.
  void pass_heartbeats() { can.expect_heartbeat(update.is_on_trial() ? CanPort::every_node : host.node()); }

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
  Lease lease;
  /// Communication was reset: the tick period and the identifiers of the state frames have their defaults.
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
