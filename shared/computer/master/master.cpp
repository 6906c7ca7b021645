#include "shared/computer/master/master.hpp"

#include <algorithm>

#include "shared/canopen/robot_configuration.hpp"

namespace proleg::canopen {

Master::Master(CanPort& port, const RobotSetup& setup, const MasterOptions& options, std::span<Change> changes)
    : setup_(setup), options_(options), plan_(setup.kernel, changes), queue_(port) {
  joint_of_.fill(no_joint);
}

void Master::start(Microseconds now) {
  if (state_ != MasterState::idle) {
    return;
  }
  now_ = now;
  mission_ = Mission::bring_up;
  if (const std::optional<Problem> problem = check_setup()) {
    fail(*problem);
    return;
  }
  if (const std::optional<Problem> problem = check_change()) {
    fail(*problem);
    return;
  }
  crc_ = configuration_crc(setup_);
  for (std::uint8_t joint = 0; joint < setup_.kernel.joint_count; ++joint) {
    joint_of_[setup_.nodes[joint]] = joint;
  }
  sdo_clients_.set_attempts(options_.attempts);
  // Until the robot belongs to this host, another host must not take these heartbeats for those of its own session.
  heartbeat_at_ = options_.resets_modules ? (options_.session_token == 0 ? now + listening_time_us : never) : now;
  enter(options_.resets_modules ? Phase::listen : Phase::scan);
  poll(now);
}

bool Master::extend_changes(Microseconds now, std::span<Change> changes) {
  if (ChangePlan(setup_.kernel, changes, plan_.size()).find_bad()) {
    return false;
  }
  plan_.extend(changes);
  if (is_running()) {
    now_ = now;
    advance(now);
  }
  return true;
}

void Master::stop(Microseconds now) {
  if (state_ == MasterState::idle || mission_ == Mission::stop) {
    return;
  }
  now_ = now;
  if (!owns_robot_ ||
      ((problem_.code == ProblemCode::other_host || problem_.code == ProblemCode::lease_refused) && !is_powered_)) {
    state_ = MasterState::stopped;
    heartbeat_at_ = never;
    enter(Phase::none);
    return;
  }
  sdo_clients_.set_attempts(std::min(options_.attempts, max_stop_attempts));
  state_ = MasterState::stopping;
  mission_ = Mission::stop;
  silence_at_ = never;
  sync_lost_at_ = never;
  start_joints_ = {};
  reset_joints_ = {};
  start_all_pending_ = false;
  joints_ = booted_;
  const bool ramps = options_.ramps_down && is_powered_;
  stop_joints_ = ramps ? booted_ : JointMask();
  enter(ramps ? Phase::ramp : Phase::disable);
  advance(now);
}

// Handlers of events.

void Master::receive(Microseconds now, const CanFrame& frame) {
  if (state_ == MasterState::idle) {
    return;
  }
  now_ = now;
  heard_at_ = frame.identifier == identifier::heartbeat + host_node ? heard_at_ : now;
  if (frame.identifier == identifier::sync) {
    if (const std::optional<std::uint8_t> counter = decode_sync(frame)) {
      ticks_.sync(*counter);
      ticks_until_ = now + silence_us;
      on_tick_passed();
    }
  } else if (const std::optional<TickMessage> message = decode_tick(frame)) {
    ticks_.announce(message->tick);
  } else {
    switch (identifier::base_of(frame.identifier)) {
      case identifier::sdo_answer:
        sdo_clients_.receive(now, frame, *this);
        look_at_answers();
        break;
      case identifier::heartbeat:
        on_heartbeat(frame);
        break;
      case identifier::emergency:
        on_emergency(frame);
        break;
      default:
        return;
    }
  }
  advance(now);
}

void Master::transmitted(Microseconds now, const CanFrame& frame) {
  now_ = now;
  queue_.sent();
  if (phase_ == Phase::commit && frame.identifier == identifier::commit) {
    ++commits_sent_;
  }
  if (phase_ == Phase::reset && frame.identifier == identifier::nmt) {
    next_phase();  // boot-ups before the reset do not count
  }
  advance(now);
}

void Master::poll(Microseconds now) {
  now_ = now;
  if (now >= heartbeat_at_) {
    constexpr Microseconds until_next_try_us = 1'000;
    const bool is_unanswered = is_powered_ && now >= heard_at_ + unanswered_us;
    const bool sent = is_unanswered || queue_.push(encode(Heartbeat{host_node, NmtState::operational}));
    heartbeat_at_ += heartbeat_period_us;
    if (!sent || heartbeat_at_ <= now) {
      heartbeat_at_ = now + (sent ? heartbeat_period_us : until_next_try_us);
    }
  }
  sdo_clients_.poll(now, *this);
  watch_heartbeats();
  if (now >= sync_lost_at_) {
    fail({ProblemCode::sync_lost});
  }
  if (now >= silent_at()) {
    fail({ProblemCode::robot_silent});
  }
  if (now >= deadline_) {
    deadline_ = never;
    phase_timed_out();
  }
  advance(now);
}

Microseconds Master::next_deadline() const {
  Microseconds next = sdo_clients_.next_deadline();
  for (const Microseconds deadline : {heartbeat_at_, deadline_, silence_at_, sync_lost_at_, silent_at()}) {
    next = std::min(next, deadline);
  }
  return next;
}

void Master::on_heartbeat(const CanFrame& frame) {
  const std::optional<Heartbeat> heartbeat = decode_heartbeat(frame);
  if (!heartbeat) {
    return;
  }
  if (heartbeat->node == host_node) {
    on_other_host();  // it is another host's, because the controller does not receive its own frames
    return;
  }
  const std::uint8_t joint = joint_of_[heartbeat->node];
  if (joint == no_joint) {
    on_unknown_node(heartbeat->node, heartbeat->state == NmtState::boot_up);
    return;
  }
  heartbeat_received_at_[joint] = now_;
  if (heartbeat->state == NmtState::boot_up) {
    on_boot_up(joint);
    return;
  }
  const JointMask self = JointMask::of(joint);
  if (heartbeat->state == NmtState::operational) {
    operational_ |= self;
  } else if (operational_.contains(joint)) {
    operational_ -= self;
    if (is_running()) {
      add_event(EventKind::left_operational, heartbeat->node, static_cast<std::uint32_t>(heartbeat->state));
    }
  }
  if (is_running() && (lost_ - given_up_ - restarted_).contains(joint)) {
    lost_ -= self;
    add_event(EventKind::heartbeat_returned, heartbeat->node);
    if (outdated_.contains(joint)) {
      reset_joints_ |= self;  // it has old values; after the reset it is set up again
    }
  }
}

void Master::on_boot_up(unsigned joint) {
  const JointMask self = JointMask::of(joint);
  const std::uint8_t node = setup_.nodes[joint];
  if (is_before_reset()) {
    return;  // it will boot again
  }
  if (mission_ == Mission::bring_up) {
    const bool is_expected = reset_again_.contains(joint) && (phase_ == Phase::scan || phase_ == Phase::quiet);
    if (is_expected && booted_.contains(joint)) {
      reset_again_ -= self;
    } else if (booted_.contains(joint)) {
      fail(problem_of(ProblemCode::duplicate_node, joint));
    }
    booted_ |= self;
    return;
  }
  operational_ -= self;
  sdo_clients_.cancel(joint);
  joints_ -= self;
  start_joints_ -= self;
  reset_joints_ -= self;
  if (!is_running()) {
    return;
  }
  ++restarts_;
  add_event(EventKind::restarted, node, restarts_);
  lost_ -= self;
  given_up_ -= self;
  restarted_ |= self;
  if (joint == options_.sync_producer) {
    fail(problem_of(ProblemCode::sync_lost, joint));  // the other modules receive no SYNC
  }
}

void Master::on_emergency(const CanFrame& frame) {
  const std::optional<Emergency> emergency = decode_emergency(frame);
  if (!emergency || emergency->node == host_node) {
    return;
  }
  if (is_before_reset()) {
    return;  // the frame belongs to an earlier run
  }
  events_.add(
      {now_, EventKind::emergency, emergency->node, emergency->error_register, emergency->code, emergency->detail});
  const std::uint8_t joint = joint_of_[emergency->node];
  if (joint == no_joint) {
    on_unknown_node(emergency->node, false);
  } else if (mission_ == Mission::bring_up && emergency->code == EmergencyCode::identifier_collision) {
    fail(problem_of(ProblemCode::duplicate_node, joint));
  }
}

void Master::on_other_host() {
  if (phase_ == Phase::take_lease && has_lease_) {
    return;  // the leases decide which of the two hosts gets the robot
  }
  if (phase_ == Phase::take_lease && is_lease_refused_) {
    fail_without_lease(joint_of_[lease_node_]);
  } else if (mission_ == Mission::bring_up && options_.resets_modules && !is_powered_) {
    fail({ProblemCode::other_host});
    heartbeat_at_ = never;  // modules that the other host drives must miss that heartbeat only
  } else if (!other_host_reported_) {
    other_host_reported_ = true;
    add_event(EventKind::other_host, host_node);
  }
}

void Master::on_unknown_node(std::uint8_t node, bool boots) {
  if (options_.allows_others || is_before_reset()) {
    return;  // another host may drive it; if not, it will boot
  }
  if (mission_ == Mission::bring_up) {
    Problem problem{ProblemCode::unexpected_node};
    problem.node = node;
    fail(problem);
  } else if (is_running() && boots) {
    add_event(EventKind::unexpected_node, node);
  }
}

void Master::on_tick_passed() {
  if (!is_running()) {
    return;
  }
  sync_lost_at_ = now_ + robot_silence_us;
  if (const std::optional<std::uint32_t> tick = ticks_.tick(); tick && *tick >= ticks_on_the_way) {
    plan_.pass(*tick - ticks_on_the_way);  // the change is also in force in a module that has missed the last SYNC
  }
}

void Master::watch_heartbeats() {
  if (now_ < silence_at_) {
    return;
  }
  silence_at_ = never;
  const JointMask not_expected = lost_ | restarted_ | (mission_ == Mission::rejoin ? joints_ : JointMask());
  for (unsigned joint = 0; joint < setup_.kernel.joint_count; ++joint) {
    if (not_expected.contains(joint)) {
      continue;
    }
    const Microseconds silent_at = heartbeat_received_at_[joint] + silence_us;
    if (silent_at <= now_ && gets_power()) {
      fail(problem_of(ProblemCode::module_silent, joint));
      return;
    }
    if (silent_at <= now_) {
      lost_ |= JointMask::of(joint);
      add_event(EventKind::silent, setup_.nodes[joint]);
    } else {
      silence_at_ = std::min(silence_at_, silent_at);
    }
  }
  // A module whose heartbeat returns is watched again after this time at the latest.
  silence_at_ = silence_at_ == never ? now_ + silence_us : silence_at_;
}

/// A robot whose answers come late must not get power. Requests that were lost make single answers late, too.
void Master::look_at_answers() {
  const Durations& answers_us = sdo_clients_.answers_us();
  if (mission_ != Mission::bring_up || phase_ != Phase::set_up ||
      (answers_us.count() != answers_to_look_at && !sdo_clients_.done())) {
    return;
  }
  if (const std::uint64_t median_us = answers_us.median().value_or(0); median_us > latest_answers_us) {
    fail(late_answers(median_us));
  }
}

// Handlers of problems.

Problem Master::late_answers(Microseconds found_us) {
  Problem problem{ProblemCode::late_answers};
  problem.found = static_cast<std::uint32_t>(found_us / 1'000);
  problem.expected = static_cast<std::uint32_t>(latest_answers_us / 1'000);
  return problem;
}

Problem Master::problem_of(ProblemCode code, unsigned joint) const {
  Problem problem{code};
  problem.joint = static_cast<std::uint8_t>(joint);
  problem.node = setup_.nodes[joint];
  return problem;
}

std::optional<Problem> Master::check_setup() const {
  const std::size_t joints = setup_.kernel.joint_count;
  if (joints == 0 || joints > max_joints || setup_.nodes.size() != joints || setup_.limits.size() != joints ||
      (!options_.serials.empty() && options_.serials.size() != joints) || options_.sync_producer >= joints) {
    return Problem{ProblemCode::bad_setup};
  }
  std::array<bool, max_node_id + 1> taken{};
  for (unsigned joint = 0; joint < joints; ++joint) {
    const std::uint8_t node = setup_.nodes[joint];
    if (node < min_node_id || node > max_node_id || taken[node]) {
      return problem_of(ProblemCode::bad_setup, joint);
    }
    taken[node] = true;
  }
  if (const std::uint32_t load = worst_bus_load_permille(setup_.kernel); load > max_bus_load_permille) {
    Problem problem{ProblemCode::bus_too_small};
    problem.found = load;
    problem.expected = max_bus_load_permille;
    return problem;
  }
  return std::nullopt;
}

std::optional<Problem> Master::check_change() const {
  const std::optional<std::size_t> bad = plan_.find_bad();
  if (!bad) {
    return std::nullopt;
  }
  Problem problem{ProblemCode::bad_change};
  problem.change = *bad;
  return problem;
}

void Master::fail(const Problem& problem) {
  if (state_ == MasterState::failed || mission_ == Mission::stop) {
    return;
  }
  problem_ = problem;
  state_ = MasterState::failed;
  mission_ = Mission::none;
  silence_at_ = never;
  sync_lost_at_ = never;
  start_joints_ = {};
  reset_joints_ = {};
  start_all_pending_ = false;
  enter(Phase::none);
}

void Master::report(const Problem& problem) {
  if (problem_.code == ProblemCode::none) {
    problem_ = problem;
  }
}

void Master::add_event(EventKind kind, std::uint8_t node, std::uint32_t detail) {
  events_.add({now_, kind, node, 0, EmergencyCode::none, detail});
}

}  // namespace proleg::canopen
