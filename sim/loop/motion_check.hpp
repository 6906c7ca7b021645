#pragma once

// Whether the world of this program moves as the recorded one did.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/loop/plant.hpp"
#include "sim/loop/pulse_player.hpp"
#include "sim/record/motion.hpp"
#include "sim/record/recording.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Simulates the world of a recording again: it gets the recorded servo commands and moves by hand. So the motion is
/// checked whoever computed the commands, and apart from them. Compares the poses of all links and objects, bit for
/// bit, and the recorded hashes with the recorded poses.
class MotionCheck {
 public:
  /// recording: must outlive this. Throws as Recording does.
  explicit MotionCheck(const Recording& recording);

  /// The next tick. Ticks must ascend from 0, without gaps. pulses: of the servo intervals that start in the tick.
  /// Ticks from the first restart of a module on are left out: its servo got no pulses then.
  void check(const RecordedTick& tick, std::span<const ServoPulse> pulses);

  /// Why no world was simulated, or not to the end; empty: it was.
  [[nodiscard]] const std::string& obstacle() const { return obstacle_; }
  [[nodiscard]] std::uint32_t ticks() const { return ticks_; }  ///< compared
  /// Ticks in which something was elsewhere.
  [[nodiscard]] std::uint64_t differences() const { return differences_; }
  [[nodiscard]] const std::optional<MotionDifference>& first() const { return first_; }
  /// Hash of the motion of this program; empty if no tick was compared.
  [[nodiscard]] std::string hash() const { return ticks_ > 0 ? computed_.hex() : std::string(); }
  /// The hash of the same ticks as the recording has their poses.
  [[nodiscard]] std::string recorded_hash() const { return ticks_ > 0 ? recorded_.hex() : std::string(); }
  /// Hashes of the recording's table that were compared with its poses.
  [[nodiscard]] std::uint32_t table_hashes() const { return table_hashes_; }
  /// After the last tick: the first tick whose hash in the table is not that of the recorded poses.
  [[nodiscard]] std::optional<std::uint32_t> damaged_hash() const;

 private:
  void simulate(const RecordedTick& tick, std::span<const ServoPulse> pulses);

  std::optional<Scenario> scenario_;
  std::unique_ptr<Plant> plant_;  ///< null: no world is simulated any more
  std::optional<PulsePlayer> player_;
  std::vector<RobotMove> moves_;
  std::size_t next_move_ = 0;
  std::vector<RecordedMotionHash> table_;
  std::size_t next_hash_ = 0;
  std::uint32_t end_;   ///< first tick that is left out
  bool begins_ramped_;  ///< the robot was ramped in before tick 0
  std::string obstacle_;
  std::uint32_t ticks_ = 0;
  std::uint64_t differences_ = 0;
  std::optional<MotionDifference> first_;
  MotionHash computed_;
  MotionHash recorded_;
  MotionHash all_recorded_;  ///< also of ticks that no world was simulated for
  std::uint32_t table_hashes_ = 0;
  std::optional<std::uint32_t> damaged_hash_;
};

}  // namespace proleg::sim
