#include "tools/proleg/ui/driven_robot.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::tools {
namespace {

/// End of a run that the user ends.
constexpr std::uint32_t last_tick = 0xFFFF'FFFF;
/// Commands for direct positions in a tick of 10 ms: they and the state frames of 60 modules fit on the bus.
constexpr std::size_t commands_per_tick = 16;
/// Speed at which joints move to a gait that is running, in degrees a second.
constexpr double joining_speed = 180.0;
/// A joint that is so near to the gait has joined it: what it moves in two ticks at the greatest speed of a servo.
constexpr std::int32_t nearness = (1 << 30) / 90 * 4;
/// A gait may be faster than joining_speed: then the joints follow it after this time all the same. The greatest speed
/// of the modules (0x6080) bounds the rest of the way.
constexpr unsigned longest_joining_ticks = 300;

}  // namespace

JointTargets::JointTargets(std::span<const AngleLimits> limits, std::uint32_t tick_us)
    : positions_(limits.size()), tick_us_(tick_us) {
  for (const AngleLimits& limit : limits) {
    joints_.push_back({limit.lower, limit.upper});
  }
}

void JointTargets::place(unsigned joint, std::int32_t position) {
  positions_[joint] = position;
  joints_[joint].goal = position;
}

void JointTargets::go_to(unsigned joint, std::int32_t goal, double speed) {
  constexpr double raw_per_degree = (1 << 30) / 90.0;
  Joint& moved = joints_[joint];
  moved.goal = std::clamp(goal, moved.lower, moved.upper);
  moved.step = std::max<std::int64_t>(1, static_cast<std::int64_t>(speed * raw_per_degree * tick_us_ * 1e-6));
}

void JointTargets::halt() {
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    joints_[joint].goal = positions_[joint];
  }
}

void JointTargets::advance() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const std::int64_t way = std::int64_t{joint.goal} - positions_[i];
    if (way != 0) {
      positions_[i] = static_cast<std::int32_t>(positions_[i] + std::clamp(way, -joint.step, joint.step));
      joint.has_moved = true;
    }
  }
}

std::vector<unsigned> JointTargets::take_moved(std::size_t at_most) {
  std::vector<unsigned> moved;
  for (std::size_t looked = 0; looked < joints_.size() && moved.size() < at_most; ++looked) {
    if (std::exchange(joints_[turn_].has_moved, false)) {
      moved.push_back(static_cast<unsigned>(turn_));
    }
    turn_ = (turn_ + 1) % joints_.size();
  }
  return moved;
}

DrivenRobot::DrivenRobot(const sim::Scenario& scenario, host::BusConnection& bus, bool holds,
                         std::unique_ptr<sim::Recorder> recorder, Listener listener)
    : scenario_(scenario),
      bus_(bus),
      holds_(holds),
      recorder_(std::move(recorder)),
      listener_(std::move(listener)),
      gait_(scenario, bus, {last_tick, holds}),
      requests_(bus),
      requests_attachment_(bus, requests_),
      targets_(scenario.joint_limits, scenario.kernel.tick_period_us),
      ghost_(scenario),
      commands_(scenario.joint_limits.size()) {
  gait_.start();
}

void DrivenRobot::poll() {
  if (state_ == State::starting && gait_.state() == canopen::MasterState::running) {
    on_started();
  }
  gait_.report_events(false, [this](const std::string& line) { listener_.report(line, false); });
  for (const std::uint8_t node_id : gait_.take_rejoined()) {
    const auto module = std::ranges::find(scenario_.modules, node_id, &sim::ModulePlace::node);
    if (module != scenario_.modules.end()) {
      place_where_it_holds(static_cast<unsigned>(module - scenario_.modules.begin()));
    }
  }
  if (const auto ghost_failure = ghost_.take_failure()) {
    listener_.report(*ghost_failure, false);
  }
  try {
    gait_.take_ticks(gait_.state() == canopen::MasterState::stopped,
                     {.tick = [this](const Change* change) { on_tick(change); },
                      .changed = [this](const Change& change) { listener_.changed(change); }});
  } catch (const std::exception& error) {
    fail(one_line(error.what()));
  }
  switch (state_) {
    case State::stopping:
      if (gait_.has_stopped()) {
        gait_.compare_setpoints();
        end_recording();
        state_ = State::stopped;
      }
      return;
    case State::stopped:
      return;
    default:
      gait_.release_changes();
      break;
  }
  if (gait_.has_ended()) {
    fail(gait_.why_ended());
  } else if (mode_failed_) {
    fail("a module has not confirmed its new mode");
  }
}

void DrivenRobot::on_started() {
  if (!holds_) {
    gait_.watch();
    state_ = State::running;
    return;
  }
  is_in_gait_mode_ = false;
  for (unsigned joint = 0; joint < commands_.size(); ++joint) {
    place_where_it_holds(joint);
  }
  gait_.gait_watch().expect_mode(canopen::mode_direct_position);
  gait_.watch();
  state_ = State::held;
}

/// The joint has got power in order to hold.
void DrivenRobot::place_where_it_holds(unsigned joint) {
  const std::int32_t angle = gait_.drive().master().held_angle(joint);
  targets_.place(joint, angle == canopen::position_not_measured ? 0 : angle);
}

void DrivenRobot::on_tick(const Change* change) {
  sim::TickSample sample = gait_.check().sample(gait_.drive());
  if (!is_in_gait_mode_) {
    move_targets();
    pulses_.clear();
    for (unsigned joint = 0; joint < commands_.size(); ++joint) {
      commands_[joint] = servo_command(targets_.positions()[joint]);
      pulses_.push_back({0, joint, commands_[joint]});
    }
    sample.setpoints = targets_.positions();
    sample.servo_pulses = pulses_;
    sample.servo_commands = commands_;
  }
  record(sample, change);
  ghost_.follow(sample.tick, {sample.servo_pulses.begin(), sample.servo_pulses.end()});
  const std::optional<Ghost::State> ghost = ghost_.state();
  if (ghost) {
    sample.link_poses = ghost->link_poses;
    sample.motor_torques = ghost->motor_torques;
    sample.contact_forces = ghost->contact_forces;
  }
  std::vector<bool> measured;
  for (unsigned joint = 0; joint < commands_.size(); ++joint) {
    const auto& monitoring = gait_.drive().monitoring(joint);
    measured.push_back(monitoring && monitoring->angle != canopen::Monitoring::not_measured);
  }
  listener_.tick(sample, ghost ? std::span<const double>(ghost->joint_angles) : std::span<const double>(), measured);
}

/// One tick on, and to the modules.
void DrivenRobot::move_targets() {
  if (state_ == State::joining) {
    const std::span<const std::int32_t> gait = gait_.check().setpoints();
    bool are_near = true;
    for (unsigned joint = 0; joint < gait.size(); ++joint) {
      targets_.go_to(joint, gait[joint], joining_speed);
      are_near = are_near && std::abs(std::int64_t{gait[joint]} - targets_.positions()[joint]) <= nearness;
    }
    ++ticks_of_joining_;
    if ((are_near || ticks_of_joining_ >= longest_joining_ticks) && !mode_on_the_way_) {
      set_mode(canopen::mode_gait);
    }
  }
  targets_.advance();
  for (const unsigned joint : targets_.take_moved(commands_per_tick)) {
    // A frame that is lost or finds no room is followed by the next one.
    static_cast<void>(bus_.send(
        encode(canopen::Command{node(joint), canopen::enable_operation_controlword, targets_.positions()[joint]})));
  }
}

void DrivenRobot::go_to(const std::vector<Goal>& goals, double speed) {
  for (const Goal& goal : goals) {
    targets_.go_to(goal.joint, goal.angle, speed);
  }
}

void DrivenRobot::follow_gait() {
  ticks_of_joining_ = 0;
  state_ = State::joining;
}

void DrivenRobot::hold() {
  end_recording();
  if (state_ == State::joining && !mode_on_the_way_) {
    targets_.halt();
    state_ = State::held;
  } else {
    set_mode(canopen::mode_direct_position);
  }
}

/// Sets the mode of all modules. For direct positions the modules report first where they hold.
void DrivenRobot::set_mode(std::int8_t mode) {
  mode_on_the_way_ = mode;
  gait_.drive().master().set_holds(mode == canopen::mode_direct_position);
  gait_.gait_watch().expect_mode(std::nullopt);
  for (unsigned joint = 0; joint < commands_.size(); ++joint) {
    ++modes_asked_for_;
    requests_.write(node(joint), canopen::object::mode.address, canopen::object::mode.type,
                    static_cast<std::uint8_t>(mode), [this, joint, mode](const host::SdoResult& result) {
                      if (result.is_good() && mode == canopen::mode_direct_position) {
                        read_target(joint);
                      }
                      on_mode_answer(result);
                    });
  }
}

void DrivenRobot::read_target(unsigned joint) {
  ++modes_asked_for_;
  requests_.read(node(joint), canopen::object::target_position.address, [this, joint](const host::SdoResult& result) {
    if (result.is_good()) {
      targets_.place(joint, static_cast<std::int32_t>(result.number()));
    }
    on_mode_answer(result);
  });
}

void DrivenRobot::on_mode_answer(const host::SdoResult& result) {
  mode_failed_ = mode_failed_ || !result.is_good();
  if (--modes_asked_for_ > 0 || !has_power() || !mode_on_the_way_) {
    return;
  }
  const std::int8_t mode = *std::exchange(mode_on_the_way_, std::nullopt);
  is_in_gait_mode_ = mode == canopen::mode_gait;
  gait_.gait_watch().expect_mode(mode);
  state_ = is_in_gait_mode_ ? State::running : State::held;
}

void DrivenRobot::stop() {
  if (!has_power()) {
    return;
  }
  end_recording();
  gait_.stop();
  state_ = State::stopping;
}

void DrivenRobot::quick_stop(const std::function<void(unsigned joint)>& confirmed) {
  for (unsigned joint = 0; joint < commands_.size(); ++joint) {
    // Sends the frame without waiting for answers first: this is the fast way, the other one is sure.
    static_cast<void>(
        bus_.send(encode(canopen::Command{node(joint), canopen::quick_stop_controlword, targets_.positions()[joint]})));
  }
  for (unsigned joint = 0; joint < commands_.size(); ++joint) {
    requests_.write(node(joint), canopen::object::controlword.address, canopen::object::controlword.type,
                    canopen::quick_stop_controlword, [joint, confirmed](const host::SdoResult& result) {
                      if (result.is_good()) {
                        confirmed(joint);
                      }
                    });
  }
  stop();
}

bool DrivenRobot::has_room_for_changes() {
  return (state_ == State::running || state_ == State::joining || state_ == State::held) && gait_.has_made_changes();
}

void DrivenRobot::record(const sim::TickSample& sample, const Change* change) {
  if (recorder_ == nullptr || !is_in_gait_mode_) {
    return;
  }
  try {
    if (change != nullptr) {
      recorder_->record_change(*change);
    }
    recorder_->record_tick(sample);
  } catch (const std::exception& error) {
    recorder_.reset();
    listener_.report("the recording has ended: " + one_line(error.what()), true);
  }
}

void DrivenRobot::end_recording() {
  if (recorder_ == nullptr) {
    return;
  }
  const std::unique_ptr<sim::Recorder> recorder = std::move(recorder_);
  const GaitCheck& check = gait_.check();
  try {
    recorder->finish(
        {{"simulated_s",
          exact_text(static_cast<double>(std::uint64_t{check.ticks()} * scenario_.kernel.tick_period_us) / 1e6)},
         {"differences", std::to_string(check.differences())},
         {"frames_missing", std::to_string(check.missing())},
         {"setpoint_hash", check.setpoint_hash().hex()},
         {"servo_hash", check.servo_hash().hex()}});
  } catch (const std::exception& error) {
    listener_.report("the recording has ended: " + one_line(error.what()), true);
  }
}

void DrivenRobot::fail(const std::string& why) {
  if (has_power()) {
    failure_ = why;
    stop();
  }
}

}  // namespace proleg::tools
