#include "sim/loop/motion_check.hpp"

#include <limits>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/ramp_in.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/record/recorded_scenario.hpp"

namespace proleg::sim {

MotionCheck::MotionCheck(const Recording& recording)
    : moves_(recording.moves()),
      table_(recording.motion_hashes()),
      end_(std::numeric_limits<std::uint32_t>::max()),
      begins_ramped_(recording.run_value("program") == "drive mirror") {
  if (const std::optional<std::uint32_t> fault = recording.first_fault_tick()) {  // no later tick is given to check()
    std::erase_if(table_, [&](const RecordedMotionHash& row) { return row.tick >= *fault; });
  }
  if (const std::vector<RecordedRestart> restarts = recording.restarts(); !restarts.empty()) {
    end_ = restarts.front().tick;
  }
  if (!recording.has_world()) {
    obstacle_ = "the robot was a real one, and no simulated world moved";
    return;
  }
  try {
    scenario_ = recorded_scenario(recording, read_overrides(recorded_overrides(recording)));
    if (!scenario_) {
      obstacle_ = "its scenario cannot be read by this program";
      return;
    }
    plant_ = std::make_unique<Plant>(*scenario_);
  } catch (const InputError& error) {
    obstacle_ = one_line(error.what());
    return;
  } catch (const PhysicsError& error) {
    obstacle_ = one_line(error.what());
    return;
  }
  player_.emplace(*plant_, ServoSchedule{scenario_->robot.servo.period_us, scenario_->kernel.tick_period_us});
}

std::optional<std::uint32_t> MotionCheck::damaged_hash() const {
  if (!damaged_hash_ && next_hash_ < table_.size()) {
    return table_[next_hash_].tick;
  }
  return damaged_hash_;
}

void MotionCheck::check(const RecordedTick& tick, std::span<const ServoPulse> pulses) {
  if (next_hash_ < table_.size()) {
    all_recorded_.append(tick.link_poses, tick.object_poses);
    if (table_[next_hash_].tick == tick.tick) {
      if (table_[next_hash_++].hash != all_recorded_.hex() && !damaged_hash_) {
        damaged_hash_ = tick.tick;
      }
      ++table_hashes_;
    }
  }
  if (plant_ == nullptr) {
    return;
  }
  if (tick.tick >= end_) {
    plant_.reset();
    obstacle_ = "a module restarted at tick " + std::to_string(end_);
    return;
  }
  try {
    simulate(tick, pulses);
  } catch (const PhysicsError& error) {
    plant_.reset();
    obstacle_ = one_line(error.what());
    ++differences_;
  } catch (const InputError& error) {  // a move to where the robot cannot be put
    plant_.reset();
    obstacle_ = one_line(error.what());
    ++differences_;
  }
}

void MotionCheck::simulate(const RecordedTick& tick, std::span<const ServoPulse> pulses) {
  if (tick.tick == 0 && begins_ramped_) {
    ramp_in(*scenario_, *plant_, *player_, pulses);
  }
  for (; next_move_ < moves_.size() && moves_[next_move_].tick <= tick.tick; ++next_move_) {
    plant_->move_robot(placement(moves_[next_move_], plant_->link_poses(), *scenario_));
  }
  player_->advance(tick.tick, pulses);
  computed_.append(plant_->link_poses(), plant_->object_poses());
  recorded_.append(tick.link_poses, tick.object_poses);
  ++ticks_;
  const std::optional<MotionDifference> difference =
      compare_motion(tick.tick, tick.link_poses, plant_->link_poses(), tick.object_poses, plant_->object_poses());
  if (difference) {
    ++differences_;
    first_ = first_ ? first_ : difference;
  }
}

}  // namespace proleg::sim
