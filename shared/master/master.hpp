#pragma once

// The master of the bus: brings up the modules of a robot, keeps them running, changes parameters in flight. Used by
// the simulator's hardware-in-the-loop and by the host program alike (docs/protocol.md). A plain state machine: frames
// and deadlines in, frames out; it never waits, and every wait of its own ends.
//
// Start: boot-up of all modules -> identity, set-up list and configuration CRC of each -> changes that fit are staged
// and committed -> NMT start -> heartbeats say Operational -> servos enabled -> one module produces SYNC: running.
// Running: changes are staged as early as the modules have room for them; a module that restarts is set up again.

#include <array>
#include <optional>
#include <span>

#include "shared/can/transmit_queue.hpp"
#include "shared/master/change_plan.hpp"
#include "shared/master/master_report.hpp"
#include "shared/master/sdo_client_pool.hpp"
#include "shared/master/tick_follower.hpp"

namespace proleg::canopen {

struct MasterOptions {
  std::uint32_t core_fingerprint = 0;        ///< of the master's own core; modules must have the same
  std::span<const std::uint32_t> serials{};  ///< kernel order, 0: any; empty: all any
  std::uint8_t sync_producer = 0;            ///< joint whose module produces SYNC
};

enum class MasterState : std::uint8_t {
  idle,        ///< before start(): hears nothing, sends nothing
  scanning,    ///< waits for the modules to boot
  setting_up,  ///< reads identities, writes set-up lists
  staging,     ///< stages and commits what changes early
  starting,    ///< waits for all to be Operational
  powering,    ///< enables the servos and SYNC
  running,
  stopping,
  stopped,
  failed,  ///< see problem(); modules are left as they are until stop()
};

class Master final : private SdoWork {
 public:
  static constexpr Microseconds heartbeat_period_us = 100'000;
  static constexpr Microseconds boot_timeout_us = 1'000'000;
  /// So long after the last expected boot-up others may show up.
  static constexpr Microseconds quiet_time_us = 50'000;
  static constexpr Microseconds start_timeout_us = 1'000'000;
  static constexpr Microseconds send_timeout_us = 1'000'000;
  static constexpr Microseconds silence_us = 500'000;
  /// Between SDO transfers while the robot moves. Their identifiers are lower than that of TICK, which would not get
  /// onto the bus beside transfers without a gap.
  static constexpr Microseconds pause_us = 300;
  /// For each answer while the robot is stopped.
  static constexpr Microseconds stop_timeout_us = 100'000;
  /// A COMMIT goes out at least so many ticks before its tick.
  static constexpr std::uint32_t commit_lead = 20;
  static constexpr unsigned commit_repeats = 3;

  struct Identity {
    std::uint32_t vendor = 0;
    std::uint32_t product = 0;
    std::uint32_t serial = 0;
  };

  /// port: to the bus, for the master alone. setup, the spans in setup and options, and changes, by ascending tick,
  /// must outlive the master.
  Master(CanPort& port, const RobotSetup& setup, const MasterOptions& options, std::span<Change> changes = {});
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  /// Checks set-up and changes, then begins to listen for boot-up messages: modules are switched on (or reset) after
  /// this. Only once.
  void start(Microseconds now);
  /// Takes the servos' power, ends the robot's ticks. From any state after start().
  void stop(Microseconds now);

  void receive(Microseconds now, const CanFrame& frame);
  /// The controller has sent a frame of the master.
  void transmitted(Microseconds now, const CanFrame& frame);
  /// Does what is due; to be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;

  [[nodiscard]] MasterState state() const { return state_; }
  /// What ended the start or the run, or the first thing that went wrong in flight; code `none` if nothing did.
  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] std::optional<Event> take_event() { return events_.take(); }
  /// Events that were not kept because no_joint took those before.
  [[nodiscard]] std::uint32_t lost_events() const { return events_.overflow(); }

  /// Tick of the last SYNC; nothing before SYNC 0.
  [[nodiscard]] std::optional<std::uint32_t> tick() const { return ticks_.tick(); }
  /// Changes that are committed or dropped: those before this position.
  [[nodiscard]] std::size_t changes_made() const { return plan_.next(); }
  [[nodiscard]] std::uint32_t restarts() const { return restarts_; }
  /// As read during set-up. joint: below the joint count.
  [[nodiscard]] const Identity& identity(unsigned joint) const { return identities_[joint]; }
  /// Joints whose modules have booted.
  [[nodiscard]] JointMask booted() const { return booted_; }

 private:
  /// What is waited for.
  enum class Phase : std::uint8_t {
    none,
    scan,
    quiet,
    set_up,
    stage,
    commit,
    nmt_start,
    enable,
    produce_sync,
    disable,
    sync_off,
  };
  /// What for.
  enum class Mission : std::uint8_t { none, bring_up, change, rejoin, stop };

  static constexpr std::uint8_t no_joint = 0xFF;
  /// A change this close to its tick is taken as passed: what is sent to one module now may be heard after it.
  static constexpr std::uint32_t ticks_on_the_way = 2;

  // SdoWork: what is written to each module in the present phase.
  [[nodiscard]] std::optional<SdoStep> step(unsigned joint, std::size_t position) override;
  [[nodiscard]] bool on_value(unsigned joint, std::size_t position, std::uint32_t value) override;
  void on_abort(unsigned joint, Address address, AbortCode code) override;
  [[nodiscard]] std::optional<SdoStep> set_up_step(unsigned joint, std::size_t position) const;
  [[nodiscard]] bool joint_failed(const Problem& problem);

  [[nodiscard]] std::optional<Problem> check_setup() const;
  [[nodiscard]] std::optional<Problem> check_change() const;

  void on_heartbeat(const CanFrame& frame);
  void on_boot_up(unsigned joint);
  void on_emergency(const CanFrame& frame);
  void on_unknown_node(std::uint8_t node, bool boots);
  void on_tick_passed();

  void advance(Microseconds now);
  void send_network_requests();
  [[nodiscard]] bool is_phase_done() const;
  void next_phase();
  void enter(Phase phase);
  void begin_mission();
  void begin_rejoin(JointMask joints);
  void stage_for_rejoin();
  void begin_commit();
  void after_commit();
  void finish_rejoin();
  void run();
  void phase_timed_out();
  void watch_heartbeats();

  [[nodiscard]] bool is_running() const { return state_ == MasterState::running; }
  [[nodiscard]] JointMask all_joints() const { return JointMask::first(setup_.kernel.joint_count); }
  [[nodiscard]] bool has_passed(const Change& change) const;
  [[nodiscard]] Problem problem_of(ProblemCode code, unsigned joint) const;
  void fail(const Problem& problem);
  void report(const Problem& problem);
  void add_event(EventKind kind, std::uint8_t node, std::uint32_t detail = 0);
  void drop_change(const Problem& problem);

  const RobotSetup& setup_;
  MasterOptions options_;
  std::uint32_t crc_ = 0;
  ChangePlan plan_;
  TransmitQueue queue_;
  SdoClientPool sdo_clients_;
  TickFollower ticks_;
  EventLog events_;

  Microseconds now_ = 0;  ///< of the event that is handled
  MasterState state_ = MasterState::idle;
  Problem problem_;
  Mission mission_ = Mission::none;
  Phase phase_ = Phase::none;
  Microseconds deadline_ = never;  ///< of the phase
  Microseconds heartbeat_at_ = never;
  Microseconds silence_at_ = never;  ///< no module is silent before
  Microseconds sync_lost_at_ = never;

  JointMask joints_;                          ///< of the mission
  JointMask booted_;                          ///< since start()
  JointMask operational_;                     ///< by their heartbeats
  JointMask restarted_;                       ///< to be set up again
  JointMask lost_;                            ///< silent, or without answers: left out of changes
  JointMask outdated_;                        ///< have missed a commit
  JointMask given_up_;                        ///< could not be set up again; only a restart of their own helps
  JointMask start_joints_ = {};               ///< to be sent NMT start
  JointMask reset_joints_ = {};               ///< to be sent NMT reset node
  bool start_all_pending_ = false;            ///< the same to all
  bool pre_operational_all_pending_ = false;  ///< Pre-operational, to all
  bool last_mission_was_rejoin_ = false;
  bool change_failed_ = false;
  std::uint32_t restarts_ = 0;

  std::size_t change_ = 0;       ///< that is staged or committed
  std::size_t rejoin_from_ = 0;  ///< changes before are written as parameters in force
  unsigned commits_queued_ = 0;
  unsigned commits_sent_ = 0;

  std::array<std::uint8_t, 128> joint_of_{};  ///< by node; `no_joint` if it is not in the set-up
  std::array<Microseconds, max_joints> heartbeat_received_at_{};
  std::array<Identity, max_joints> identities_{};
};

}  // namespace proleg::canopen
