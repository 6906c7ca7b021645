#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/computer/master/master.hpp"

// The order of phases and missions; master.hpp has the table.

namespace proleg::canopen {

void Master::advance(Microseconds now) {
  do {
    send_network_requests();
    sdo_clients_.send(now, setup_.nodes, queue_, *this);
    while (phase_ == Phase::commit && commits_queued_ < commit_repeats &&
           queue_.push(encode(CommitMessage{ChangePlan::transaction(change_), plan_[change_].tick, setup_.robot_id}))) {
      ++commits_queued_;
    }
    if (!is_phase_done()) {
      return;
    }
    next_phase();
  } while (true);
}

void Master::send_network_requests() {
  const auto send = [this](NmtCommand command, std::uint8_t node) {
    return queue_.push(encode(NmtRequest{command, node}));
  };
  const auto send_each = [this](const auto& request_to, JointMask& joints) {
    for (const unsigned joint : joints) {
      if (!queue_.push(encode(request_to(setup_.nodes[joint])))) {
        return;
      }
      joints.erase(joint);
    }
  };
  reset_all_pending_ = reset_all_pending_ && !send(NmtCommand::reset_node, 0);
  pre_operational_all_pending_ = pre_operational_all_pending_ && !send(NmtCommand::enter_pre_operational, 0);
  start_all_pending_ = start_all_pending_ && (pre_operational_all_pending_ || !send(NmtCommand::start, 0));
  // A joint must not move on while the master waits for the answer of another one, which may be cut off. Phase::ramp
  // repeats the quick stop with a confirmation. The module takes no target from the command: it is no angle of a joint.
  send_each(
      [](std::uint8_t node) {
        return Command{node, quick_stop_controlword, position_not_measured};
      },
      stop_joints_);
  send_each([](std::uint8_t node) { return NmtRequest{NmtCommand::start, node}; }, start_joints_);
  send_each([](std::uint8_t node) { return NmtRequest{NmtCommand::reset_node, node}; }, reset_joints_);
}

bool Master::is_phase_done() const {
  switch (phase_) {
    case Phase::none:
      return is_running() && (!restarted_.empty() || plan_.can_stage());
    case Phase::scan:
      return booted_ == all_joints();
    case Phase::take_lease:
      return sdo_clients_.done() && !is_lease_refused_;
    case Phase::listen:
    case Phase::reset:
    case Phase::quiet:
    case Phase::ramping:
      return false;  // they end by their deadline, or when the frame was sent
    case Phase::commit:
      return commits_sent_ >= commit_repeats;
    case Phase::nmt_start:
      return !start_all_pending_ && start_joints_.empty() && (joints_ - operational_).empty();
    default:
      return sdo_clients_.done();
  }
}

void Master::enter(Phase phase) {
  phase_ = phase;
  deadline_ = never;
  JointMask served;
  Microseconds timeout_us = options_.answer_timeout_us;
  switch (phase) {
    case Phase::none:
      break;
    case Phase::listen:
      state_ = MasterState::listening;
      deadline_ = now_ + listening_time_us;
      break;
    case Phase::take_lease:
      served = JointMask::of(joint_of_[lease_node_]);
      is_lease_refused_ = false;
      break;
    case Phase::reset:
      owns_robot_ = true;
      reset_all_pending_ = true;
      deadline_ = now_ + send_timeout_us;
      break;
    case Phase::quiet:
      deadline_ = now_ + quiet_time_us;
      break;
    case Phase::ramping:
      deadline_ = now_ + ramping_time_us;
      served = options_.reads_checksums ? joints_ : JointMask();
      timeout_us = stop_timeout_us;
      break;
    case Phase::scan:
      state_ = MasterState::scanning;
      owns_robot_ = true;
      reset_again_ = {};
      booted_ = {};
      deadline_ = now_ + (options_.resets_modules ? repeat_us : boot_timeout_us);
      requests_ = 1;
      break;
    case Phase::commit:
      commits_queued_ = 0;
      commits_sent_ = 0;
      deadline_ = now_ + send_timeout_us;
      break;
    case Phase::nmt_start:
      operational_ -= joints_;
      deadline_ = now_ + (options_.resets_modules && mission_ == Mission::bring_up ? repeat_us : start_timeout_us);
      requests_ = 1;
      break;
    case Phase::keep_lease:
    case Phase::set_up:
    case Phase::stage:
    case Phase::hold:
      served = joints_;
      break;
    case Phase::set_ramp_in:
      served = joints_;
      ramping_in_ = joints_;
      break;
    case Phase::enable:
      served = joints_;
      if (!is_powered_) {
        silence_at_ = now_ + silence_us;
        heartbeat_received_at_.fill(now_);
      }
      is_powered_ = true;
      break;
    case Phase::ramp_in:
      served = ramping_in_;
      deadline_ = now_ + Microseconds{180'000'000} / options_.ramp_in_speed + ramp_in_reserve_us;
      break;
    case Phase::produce_sync:
      served = JointMask::of(options_.sync_producer);
      break;
    case Phase::ramp:
    case Phase::disable:
      served = joints_;
      timeout_us = stop_timeout_us;
      break;
    case Phase::sync_off:
      served = joints_ & JointMask::of(options_.sync_producer);
      timeout_us = stop_timeout_us;
      break;
  }
  const bool leaves_room_for_ticks =
      is_running() || (mission_ == Mission::stop && options_.ramps_down && now_ < ticks_until_);
  if (!leaves_room_for_ticks && (phase == Phase::ramp || phase == Phase::disable || phase == Phase::sync_off)) {
    // Where no node acknowledges a frame, the queue stays full, and no request begins that could time out.
    constexpr Microseconds reserve_us = 200'000;
    const Microseconds rounds = (served.size() + SdoClientPool::clients - 1) / SdoClientPool::clients;
    const Microseconds requests = phase == Phase::disable ? 2 : 1;
    deadline_ = now_ + rounds * requests * max_stop_attempts * stop_timeout_us + reserve_us;
  }
  sdo_clients_.begin(served, timeout_us,
                     leaves_room_for_ticks     ? pause_us
                     : phase == Phase::ramp_in ? ramp_in_pause_us
                                               : 0);
  if (mission_ != Mission::bring_up) {
    return;
  }
  switch (phase) {
    case Phase::set_up:
      state_ = MasterState::setting_up;
      break;
    case Phase::stage:
      state_ = MasterState::staging;
      break;
    case Phase::nmt_start:
      state_ = MasterState::starting;
      break;
    case Phase::enable:
      state_ = MasterState::powering;
      break;
    default:
      break;
  }
}

/// Enters the phase that follows one that is done.
void Master::next_phase() {
  switch (phase_) {
    case Phase::none:
      begin_mission();
      break;
    case Phase::listen:
      begin_lease();
      break;
    case Phase::take_lease:
      take_next_lease();
      break;
    case Phase::reset:
      enter(Phase::scan);
      break;
    case Phase::scan:
      joints_ = booted_;
      enter(Phase::quiet);
      break;
    case Phase::quiet:
      enter(options_.session_token != 0 ? Phase::keep_lease : Phase::set_up);
      break;
    case Phase::keep_lease:
      enter(Phase::set_up);
      break;
    case Phase::set_up:
      change_ = rejoin_from_;
      if (mission_ == Mission::rejoin) {
        stage_for_rejoin();
      } else {
        after_commit();
      }
      break;
    case Phase::stage:
      begin_commit();
      break;
    case Phase::commit:
      after_commit();
      break;
    case Phase::nmt_start:
      if (mission_ == Mission::rejoin) {
        finish_rejoin();
      } else {
        enter(options_.ramp_in_speed != 0 ? Phase::set_ramp_in : first_with_power());
      }
      break;
    case Phase::set_ramp_in:
      enter(first_with_power());
      break;
    case Phase::hold:
      enter(Phase::enable);
      break;
    case Phase::ramp_in:
      ticks_ = {};
      enter(Phase::produce_sync);
      break;
    case Phase::enable:
      if (mission_ == Mission::rejoin) {
        start_joints_ = joints_;
        enter(Phase::nmt_start);
      } else if (options_.ramp_in_speed != 0) {
        enter(Phase::ramp_in);
      } else {
        ticks_ = {};
        enter(Phase::produce_sync);
      }
      break;
    case Phase::produce_sync:
      run();
      break;
    case Phase::ramp:
      enter(Phase::ramping);
      break;
    case Phase::ramping:
      enter(Phase::disable);
      break;
    case Phase::disable:
      is_powered_ = false;
      pre_operational_all_pending_ = true;
      enter(Phase::sync_off);
      break;
    case Phase::sync_off:
      state_ = MasterState::stopped;
      enter(Phase::none);
      break;
  }
}

void Master::phase_timed_out() {
  switch (phase_) {
    case Phase::scan:
      if (repeat_request()) {
        reset_joints_ = all_joints() - booted_;
        reset_again_ |= reset_joints_;
      } else {
        fail(problem_of(ProblemCode::missing_module, (all_joints() - booted_).front()));
      }
      break;
    case Phase::listen:
    case Phase::quiet:
    case Phase::ramping:
      next_phase();
      break;
    case Phase::take_lease:
      enter(Phase::take_lease);  // the same module is asked once more
      break;
    // Transports may lose a confirmation, so frames that left the queue count as sent.
    case Phase::reset:
      if (!reset_all_pending_) {
        next_phase();
      } else {
        fail({ProblemCode::cannot_send});
      }
      break;
    case Phase::ramp_in:
      fail(problem_of(ProblemCode::not_ramped_in, ramping_in_.front()));
      break;
    case Phase::commit:
      if (commits_sent_ > 0) {
        next_phase();
        break;
      }
      fail({ProblemCode::cannot_send});
      break;
    case Phase::nmt_start: {
      const JointMask missing = joints_ - operational_;
      if (missing.empty()) {
        fail({ProblemCode::cannot_send});
      }
      if (mission_ == Mission::bring_up && repeat_request()) {
        // All modules are started again together, since each needs the first state frames of the others.
        pre_operational_all_pending_ = true;
        request_start();
        operational_ = {};
        break;
      }
      start_all_pending_ = false;
      start_joints_ = {};
      for (const unsigned joint : missing) {
        static_cast<void>(joint_failed(problem_of(ProblemCode::not_operational, joint)));
      }
      break;
    }
    case Phase::ramp:
    case Phase::disable:
    case Phase::sync_off:
      for (const unsigned joint : phase_ == Phase::disable ? sdo_clients_.unfinished() : JointMask()) {
        add_event(EventKind::not_stopped, setup_.nodes[joint]);
      }
      sdo_clients_.cancel_all();
      next_phase();
      break;
    default:
      break;
  }
}

void Master::request_start() {
  if (options_.allows_others) {
    start_joints_ = joints_;
  } else {
    start_all_pending_ = true;
  }
}

/// Whether the request of this phase may be sent once more.
bool Master::repeat_request() {
  if (!options_.resets_modules || requests_ >= max_requests) {
    return false;
  }
  ++requests_;
  deadline_ = now_ + repeat_us;
  return true;
}

void Master::run() {
  state_ = MasterState::running;
  mission_ = Mission::none;
  sync_lost_at_ = now_ + robot_silence_us;
  enter(Phase::none);
}

/// Starts the next mission while the robot runs. Restarted modules come first, but not twice in succession: a module
/// that keeps restarting must not block changes.
void Master::begin_mission() {
  if (!restarted_.empty() && !(last_mission_was_rejoin_ && plan_.can_stage())) {
    last_mission_was_rejoin_ = true;
    const JointMask joints = restarted_;
    restarted_ = {};
    begin_rejoin(joints);
    return;
  }
  last_mission_was_rejoin_ = false;
  mission_ = Mission::change;
  change_ = plan_.next();
  change_failed_ = false;
  joints_ = all_joints() - lost_ - restarted_;
  // A change that is already too late is not staged; begin_commit() drops it.
  enter(plan_[change_].tick < ticks_.tick().value_or(0) + options_.commit_lead ? Phase::none : Phase::stage);
  if (phase_ == Phase::none) {
    begin_commit();
  }
}

void Master::drop_change(const Problem& problem) {
  report(problem);
  plan_.drop_next();
  add_event(EventKind::change_dropped, 0, plan_[change_].tick);
  mission_ = Mission::none;
  enter(Phase::none);
}

void Master::begin_commit() {
  if (mission_ == Mission::rejoin && has_passed(plan_[change_])) {
    // The change is in force by now, so its parameters must be written before any value is staged.
    begin_rejoin(joints_);
    return;
  }
  if (mission_ == Mission::change) {
    if (change_failed_) {
      drop_change(problem_);
      return;
    }
    const std::uint32_t tick = ticks_.tick().value_or(0);
    plan_.decide_tick(tick + options_.commit_lead);
    if (plan_[change_].tick < tick + options_.commit_lead) {
      Problem problem{ProblemCode::commit_too_late};
      problem.change = change_;
      problem.found = tick;
      problem.expected = plan_[change_].tick;
      drop_change(problem);
      return;
    }
  } else if (change_ == plan_.next()) {  // a change that is committed again has its tick
    plan_.decide_tick(0);
  }
  enter(Phase::commit);
}

void Master::after_commit() {
  switch (mission_) {
    case Mission::bring_up:
      if (phase_ == Phase::commit) {
        plan_.commit_next();
      }
      if (plan_.can_stage()) {
        change_ = plan_.next();
        enter(Phase::stage);
      } else {
        request_start();
        enter(Phase::nmt_start);
      }
      break;
    case Mission::change:
      plan_.commit_next();
      outdated_ |= all_joints() - joints_ - restarted_;
      mission_ = Mission::none;
      enter(Phase::none);
      break;
    case Mission::rejoin:
      ++change_;
      stage_for_rejoin();
      break;
    default:
      enter(Phase::none);
      break;
  }
}

bool Master::has_passed(const Change& change) const {
  return change.tick <= ticks_.tick().value_or(0) + ticks_on_the_way;
}

void Master::begin_rejoin(JointMask joints) {
  mission_ = Mission::rejoin;
  joints_ = joints;
  rejoin_from_ = plan_.next();
  while (rejoin_from_ > 0 && !has_passed(plan_[rejoin_from_ - 1])) {
    --rejoin_from_;
  }
  enter(options_.session_token != 0 ? Phase::keep_lease : Phase::set_up);
}

/// Stages the committed changes that wait for their tick in the restarted modules, too, and commits them again. All
/// other modules ignore the repeated commit.
void Master::stage_for_rejoin() {
  while (change_ < plan_.next() && plan_[change_].dropped) {
    ++change_;
  }
  if (joints_.empty()) {
    finish_rejoin();
  } else if (change_ == plan_.next()) {
    enter(first_with_power());  // the servo needs power from the first tick that its module computes
  } else {
    enter(Phase::stage);
  }
}

void Master::finish_rejoin() {
  for (const unsigned joint : joints_) {
    heartbeat_received_at_[joint] = now_;
    add_event(EventKind::rejoined, setup_.nodes[joint]);
  }
  outdated_ -= joints_;
  mission_ = Mission::none;
  enter(Phase::none);
}

}  // namespace proleg::canopen
