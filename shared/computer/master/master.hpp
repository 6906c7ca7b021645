#pragma once

// The master of the bus: sets up the modules of a robot, starts them and changes parameters while the robot moves. The
// simulator's hardware-in-the-loop and the host program use it (docs/protocol.md). It is a state machine with frames
// and deadlines as inputs and frames as outputs. It never blocks, and each of its waits has a timeout.
//
// A mission is the present task of the master. Its phases follow each other in this order:
//
//   mission   starts when                    phases                                 joints_
//   bring_up  start()                        (listen, take_lease, reset,) scan,     all that booted, which are all of
//                                            quiet, (keep_lease,) set_up,           the set-up; take_lease: one after
//                                            then for each change that fits:        the other; produce_sync: only the
//                                            stage, commit; nmt_start,              SYNC producer
//                                            (set_ramp_in,) (hold,) enable,
//                                            (ramp_in,) produce_sync
//   change    running, and modules have      stage, commit                          all without lost_ and restarted_
//             room for the next change
//   rejoin    running, restarted_ not empty  (keep_lease,) set_up, then for each    the members that restarted_ had
//                                            committed change that waits for its
//                                            tick: stage, commit; (hold,) enable,
//                                            nmt_start
//   stop      stop()                         (ramp, ramping,) disable, sync_off     booted_; sync_off: only the SYNC
//                                                                                   producer. Before `ramp` all get the
//                                                                                   quick stop without a confirmation.
//                                                                                   While they are ramping, their
//                                                                                   checksums are read
//   none      no other mission               none                                   not used
//
// Phases in parentheses are left out unless the options demand them.
//
// A change that has passed its tick before its commit in `rejoin` starts that mission again from set_up. A change that
// is too late for its tick leaves out `stage` and is dropped.
//
// Sets of joints while the robot runs:
//
//   lost_        silent or without an answer   enters: timeouts         leaves: heartbeat returns, or boot-up
//   outdated_    has missed a commit           enters: end of `change`  leaves: end of `rejoin`
//   restarted_   must be set up again          enters: boot-up          leaves: `rejoin` begins
//   given_up_    could not be set up again     enters: `rejoin` fails   leaves: boot-up
//   A joint of outdated_ whose heartbeat returns is reset, so that its boot-up puts it into restarted_.

#include <array>
#include <optional>
#include <span>

#include "shared/can/transmit_queue.hpp"
#include "shared/computer/master/change_plan.hpp"
#include "shared/computer/master/master_report.hpp"
#include "shared/computer/master/sdo_client_pool.hpp"
#include "shared/computer/master/tick_follower.hpp"

namespace proleg::canopen {

struct MasterOptions {
  std::uint32_t core_fingerprint = 0;        ///< fingerprint of the master's own core; modules must have the same
  std::span<const std::uint32_t> serials{};  ///< serial numbers of the modules in kernel order, 0: any; empty: all any
  std::uint8_t sync_producer = 0;            ///< joint whose module produces SYNC
  /// Whether the modules may be on already, in any state: start() listens for another host, then resets all of them.
  bool resets_modules = false;
  /// Whether nodes that are not in the set-up may boot and send. The master does not change them.
  bool allows_others = false;
  /// Whether stop() lets the joints of a moving robot ramp to their safe pose (quick stop) before it takes their power.
  bool ramps_down = false;
  /// Whether the master reads the checksums of the modules' set-points (0x200D) while the joints ramp down.
  bool reads_checksums = false;
  /// Speed at which joints move from their measured angles to the start of the gait before SYNC 0 (0x200E) [deg/s], 1
  /// to max_command_speed; 0: they do not. The master waits for all joints that measure their angles.
  std::uint16_t ramp_in_speed = 0;
  /// Whether the joints do not follow the gait: they stay at the angles that they measure (mode direct position,
  /// 0x6060), until the host sends other angles or switches the mode. See Master::set_holds().
  bool holds = false;
  /// Random token of this host's session. With it the master takes the lease of the robot (0x2002) before it resets the
  /// modules, and again when it sets them up. 0: without a lease.
  std::uint32_t session_token = 0;
  /// Time for each SDO answer; more for a slow connection.
  Microseconds answer_timeout_us = SdoTransferOptions{}.timeout_us;
  /// Number of times that a request is sent without an answer; more for a connection that loses frames.
  unsigned attempts = 1;
  /// Least number of ticks before its tick at which a COMMIT is sent.
  std::uint32_t commit_lead = 20;
};

enum class MasterState : std::uint8_t {
  idle,        ///< before start(): ignores all frames, sends none
  listening,   ///< listens for another host, before it resets the modules
  scanning,    ///< waits for the modules to boot
  setting_up,  ///< reads identities, writes set-up lists
  staging,     ///< stages and commits the first changes
  starting,    ///< waits until all modules are Operational
  powering,    ///< enables the servos, lets them ramp in, and starts SYNC
  running,
  stopping,
  stopped,
  failed,  ///< see problem(); the modules stay in their states until stop()
};

class Master final : private SdoWork {
 public:
  static constexpr Microseconds heartbeat_period_us = 100'000;
  /// Time without a frame of any module after which the heartbeat pauses while servos have power: the way back is cut,
  /// perhaps, and then the modules stop by themselves, also if no other frame of the host reaches them.
  static constexpr Microseconds unanswered_us = 200'000;
  /// Time in which another host sends three heartbeats.
  static constexpr Microseconds listening_time_us = 300'000;
  /// Time for which another host may have the lease without a heartbeat: its session is over then, and its lease ends.
  static constexpr Microseconds lease_timeout_us = 700'000;
  static constexpr Microseconds lease_pause_us = 50'000;
  /// Time that the joints get to ramp down. A quick stop moves at 90 degrees a second, over at most 90 degrees; then
  /// the servo, which is behind its pulses, settles.
  static constexpr Microseconds ramping_time_us = 1'200'000;
  /// Time that joints get to ramp in beyond the time of a ramp over 180 degrees.
  static constexpr Microseconds ramp_in_reserve_us = 2'000'000;
  /// Time between two requests of the master whether a joint has ramped in.
  static constexpr Microseconds ramp_in_pause_us = 5'000;
  static constexpr Microseconds boot_timeout_us = 1'000'000;
  /// Time after the last expected boot-up in which unexpected modules may appear.
  static constexpr Microseconds quiet_time_us = 50'000;
  static constexpr Microseconds start_timeout_us = 1'000'000;
  /// Time after which a reset or a start without an effect is sent again, with options.resets_modules. One of its
  /// frames, or of the answers, may have been lost.
  static constexpr Microseconds repeat_us = 500'000;
  static constexpr unsigned max_requests = 3;
  static constexpr Microseconds send_timeout_us = 1'000'000;
  /// Time without the heartbeat of a module after which it is silent.
  static constexpr Microseconds silence_us = 500'000;
  /// Time after which the robot is silent: without SYNC while it runs, without any frame while it gets power. Then a
  /// joint that is 90 degrees from its safe pose is there 1.4 s after its last frame (docs/safety.md).
  static constexpr Microseconds robot_silence_us = 400'000;
  /// Time between SDO transfers while the robot moves. Their identifiers are lower than that of TICK, so transfers
  /// without pauses would keep TICK from the bus.
  static constexpr Microseconds pause_us = 300;
  /// Time for an SDO answer during stop().
  static constexpr Microseconds stop_timeout_us = 100'000;
  static constexpr unsigned max_stop_attempts = 3;
  static constexpr unsigned commit_repeats = 3;
  /// Median of the answers in the set-up, above which the servos get no power: a command to stop would come too late.
  static constexpr Microseconds latest_answers_us = 300'000;
  /// Number of answers after which the master looks at it for the first time.
  static constexpr std::uint64_t answers_to_look_at = 40;

  struct Identity {
    std::uint32_t vendor = 0;
    std::uint32_t product = 0;
    std::uint32_t serial = 0;
  };

  /// Result of the module of a joint, as in objects 0x200D:1 and 2.
  struct SetpointChecksum {
    enum class State : std::uint8_t {
      not_read,       ///< the module has not answered, or was not asked
      not_available,  ///< the module has no such object
      read,
    };
    State state = State::not_read;
    /// Number of ticks from tick 0 on; 0: the module has not computed the set-points of all ticks.
    std::uint32_t ticks = 0;
    std::uint32_t crc = 0;  ///< CRC-32 (shared/fixed/crc32.hpp) of the int32 set-points, little-endian
  };

  /// port: must be used by the master only. changes: by ascending tick. setup, changes and the spans in setup and
  /// options must outlive the master.
  Master(CanPort& port, const RobotSetup& setup, const MasterOptions& options, std::span<Change> changes = {});
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  /// Checks set-up and changes, then waits for boot-up messages: modules must be switched on (or reset) after this
  /// call. Only the first call has an effect.
  void start(Microseconds now);
  /// Adds changes behind the earlier ones, while the robot runs or before. changes: those that the master has, as they
  /// are (it has set `dropped`, and the ticks of those that were `soon`), and new ones. They must outlive the master,
  /// or be replaced by another call. False, without an effect, if one of the new ones is not possible.
  [[nodiscard]] bool extend_changes(Microseconds now, std::span<Change> changes);
  /// Switches off the servos and the SYNC of the robot. It may be called in any state after start(). It sends nothing
  /// as long as the master has only listened, or if the robot belongs to another host. With options.ramps_down all
  /// joints that move get the quick stop at once, whether their modules answer or not. A module that does not confirm
  /// that its servo has no power is reported as an event.
  void stop(Microseconds now);
  /// Must be called when the host has switched the mode of the joints: a module that restarts gets the same mode
  /// (MasterOptions::holds).
  void set_holds(bool holds) { options_.holds = holds; }

  void receive(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller has sent a frame of the master.
  void transmitted(Microseconds now, const CanFrame& frame);
  /// Handles timeouts. Must be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;

  [[nodiscard]] MasterState state() const { return state_; }
  /// The problem that ended the start or the run, or the first problem while the robot moves; code `none` without a
  /// problem.
  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] std::optional<Event> take_event() { return events_.take(); }
  /// Number of events that were dropped because the log was full.
  [[nodiscard]] std::uint32_t lost_events() const { return events_.overflow(); }

  /// Tick of the last SYNC; nothing before SYNC 0.
  [[nodiscard]] std::optional<std::uint32_t> tick() const { return ticks_.tick(); }
  /// Number of changes that are committed or dropped: those before this position.
  [[nodiscard]] std::size_t changes_made() const { return plan_.next(); }
  [[nodiscard]] std::uint32_t restarts() const { return restarts_; }
  /// Identity of the module of a joint, as read during set-up. joint: below the joint count.
  [[nodiscard]] const Identity& identity(unsigned joint) const { return identities_[joint]; }
  /// Checksum of the module of a joint, with options.reads_checksums, from stop() on. joint: below the joint count.
  [[nodiscard]] const SetpointChecksum& checksum(unsigned joint) const { return checksums_[joint]; }
  /// The angle that the joint had when it got power (90 degrees = 2^30), with options.holds and while running;
  /// position_not_measured: its module does not measure it. joint: below the joint count.
  [[nodiscard]] std::int32_t held_angle(unsigned joint) const { return static_cast<std::int32_t>(measured_[joint]); }
  /// Joints whose modules have booted.
  [[nodiscard]] JointMask booted() const { return booted_; }

 private:
  /// The phases of a mission: what the master waits for.
  enum class Phase : std::uint8_t {
    none,
    listen,
    take_lease,
    reset,
    scan,
    quiet,
    keep_lease,
    set_up,
    stage,
    commit,
    nmt_start,
    set_ramp_in,
    hold,
    enable,
    ramp_in,
    produce_sync,
    ramp,
    ramping,
    disable,
    sync_off,
  };
  /// The missions.
  enum class Mission : std::uint8_t { none, bring_up, change, rejoin, stop };

  static constexpr std::uint8_t no_joint = 0xFF;
  /// Number of ticks before its tick at which a change counts as passed: a frame that is sent now may be received after
  /// the tick.
  static constexpr std::uint32_t ticks_on_the_way = 2;

  // Functions of SdoWork: the transfers of the present phase.
  [[nodiscard]] std::optional<SdoRequest> request(unsigned joint, std::size_t position) override;
  [[nodiscard]] bool on_value(unsigned joint, std::size_t position, std::uint32_t value) override;
  void on_abort(unsigned joint, Address address, AbortCode code) override;
  [[nodiscard]] std::optional<SdoRequest> set_up_request(unsigned joint, std::size_t position) const;
  [[nodiscard]] std::size_t user_algorithm_count() const;
  [[nodiscard]] const Declaration& user_algorithm(std::size_t position) const;
  bool algorithm_missing(unsigned joint, const Declaration& algorithm, std::uint32_t found);
  [[nodiscard]] std::optional<SdoRequest> checksum_request(std::size_t position) const;
  [[nodiscard]] std::optional<SdoRequest> lease_request(std::size_t position) const;
  [[nodiscard]] bool on_lease(unsigned joint, std::uint32_t holder);
  void on_lease_abort(unsigned joint, Address address, AbortCode code);
  void refuse_lease(unsigned joint);
  void fail_without_lease(unsigned joint);
  void begin_lease();
  void take_next_lease();
  [[nodiscard]] std::optional<SdoRequest> ramp_in_request(unsigned joint, std::size_t position) const;
  [[nodiscard]] std::optional<SdoRequest> hold_request(unsigned joint, std::size_t position) const;
  void on_checksum(unsigned joint, std::size_t position, std::uint32_t value);
  [[nodiscard]] bool joint_failed(const Problem& problem);

  [[nodiscard]] std::optional<Problem> check_setup() const;
  [[nodiscard]] std::optional<Problem> check_change() const;

  void on_heartbeat(const CanFrame& frame);
  void on_boot_up(unsigned joint);
  void on_emergency(const CanFrame& frame);
  void on_other_host();
  void on_unknown_node(std::uint8_t node, bool boots);
  void on_tick_passed();

  void advance(Microseconds now);
  void send_network_requests();
  [[nodiscard]] bool is_phase_done() const;
  void next_phase();
  void enter(Phase phase);
  void begin_mission();
  [[nodiscard]] Phase first_with_power() const { return options_.holds ? Phase::hold : Phase::enable; }
  void begin_rejoin(JointMask joints);
  void stage_for_rejoin();
  void begin_commit();
  void after_commit();
  void finish_rejoin();
  void run();
  void phase_timed_out();
  void request_start();
  [[nodiscard]] bool repeat_request();
  void watch_heartbeats();
  void look_at_answers();
  [[nodiscard]] bool gets_power() const { return mission_ == Mission::bring_up && is_powered_; }
  [[nodiscard]] Microseconds silent_at() const { return gets_power() ? heard_at_ + robot_silence_us : never; }

  [[nodiscard]] bool is_before_reset() const {
    return phase_ == Phase::listen || phase_ == Phase::take_lease || phase_ == Phase::reset;
  }
  [[nodiscard]] bool is_running() const { return state_ == MasterState::running; }
  [[nodiscard]] JointMask all_joints() const { return JointMask::first(setup_.kernel.joint_count); }
  [[nodiscard]] bool has_passed(const Change& change) const;
  [[nodiscard]] static Problem late_answers(Microseconds found_us);
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

  Microseconds now_ = 0;  ///< time of the present event
  MasterState state_ = MasterState::idle;
  Problem problem_;
  Mission mission_ = Mission::none;
  Phase phase_ = Phase::none;
  Microseconds deadline_ = never;  ///< deadline of the phase
  Microseconds heartbeat_at_ = never;
  Microseconds silence_at_ = never;  ///< time of the next check of heartbeats
  Microseconds sync_lost_at_ = never;
  Microseconds heard_at_ = 0;     ///< time of the last frame of a module
  Microseconds ticks_until_ = 0;  ///< without another SYNC there are no ticks from this time on

  JointMask joints_;                ///< joints of the mission
  JointMask ramping_in_ = {};       ///< joints that are not yet at the start of the gait
  JointMask booted_;                ///< joints that have booted since start()
  JointMask operational_;           ///< joints that are Operational by their heartbeats
  JointMask restarted_;             ///< joints that must be set up again
  JointMask lost_;                  ///< joints that are silent, or without answers; changes leave them out
  JointMask outdated_;              ///< joints that have missed a commit
  JointMask given_up_;              ///< joints that could not be set up again, and wait for a restart
  JointMask start_joints_ = {};     ///< joints to which NMT start is pending
  JointMask reset_joints_ = {};     ///< joints to which NMT reset node is pending
  JointMask stop_joints_ = {};      ///< joints to which the command for a quick stop is pending
  JointMask reset_again_;           ///< joints that were reset once more in `scan`: both of their boot-ups may come
  bool start_all_pending_ = false;  ///< NMT start to all is pending
  bool reset_all_pending_ = false;  ///< NMT reset node to all is pending
  bool pre_operational_all_pending_ = false;  ///< NMT enter Pre-operational to all is pending
  bool last_mission_was_rejoin_ = false;
  bool change_failed_ = false;
  bool owns_robot_ = false;  ///< whether the master has begun to change the modules: before that it only listens
  bool is_powered_ = false;  ///< whether servos may have power
  bool other_host_reported_ = false;
  std::uint32_t restarts_ = 0;

  // State of the lease before the reset.
  std::uint8_t lease_node_ = 0;     ///< node whose lease is taken, in ascending order
  Microseconds lease_ends_ = 0;     ///< end of the lease of a session without a heartbeat
  bool has_lease_ = false;          ///< the lease of at least one module is taken
  bool only_reads_lease_ = false;   ///< a request to take the lease was sent, so it is only read
  bool is_lease_refused_ = false;   ///< the present module has refused the lease
  bool has_missing_lease_ = false;  ///< the lease of at least one module is missing

  std::size_t change_ = 0;       ///< position of the change that is staged or committed
  std::size_t rejoin_from_ = 0;  ///< earlier changes are written as parameters in force
  unsigned requests_ = 0;        ///< number of resets or starts that were sent in the present phase
  unsigned commits_queued_ = 0;
  unsigned commits_sent_ = 0;

  std::array<std::uint8_t, host_node + 1>
      joint_of_{};  ///< joint of each node; `no_joint` if the node is not in the set-up
  std::array<Microseconds, max_joints> heartbeat_received_at_{};
  std::array<Identity, max_joints> identities_{};
  std::array<SetpointChecksum, max_joints> checksums_{};
  std::array<std::uint32_t, max_joints> measured_{};  ///< angles of joints that hold, as in 0x6064
};

}  // namespace proleg::canopen
