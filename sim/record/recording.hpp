#pragma once

// Reads recordings.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/record/motion.hpp"
#include "sim/record/recorded_run.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg {
class Statement;
}

namespace proleg::sim {

/// A recording as it was when it was opened; a recorder may write into the file meanwhile.
///
/// Throws InputError if the file is missing, is no recording, has a newer format, is damaged or has no tick, and
/// FileError if the system cannot read it. Never changes the file.
class Recording {
 public:
  explicit Recording(const std::filesystem::path& path);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// False for a run that was interrupted or is still running.
  [[nodiscard]] bool finished() const { return finished_; }
  /// Value from the table `run`, e.g. "seed"; empty if the table has no such key.
  [[nodiscard]] std::string run_value(const std::string& key) const;
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& results() const { return results_; }

  [[nodiscard]] std::uint32_t tick_period_us() const { return tick_period_us_; }
  [[nodiscard]] std::uint32_t first_tick() const { return first_tick_; }
  [[nodiscard]] std::uint32_t last_tick() const { return last_tick_; }
  /// Seconds from the start to SYNC tick + 1, at which the results of a tick hold.
  [[nodiscard]] double time_s(std::uint32_t tick) const { return (tick + 1.0) * tick_period_us_ / 1e6; }
  /// Seconds from the start to SYNC `tick`, when its contacts were latched.
  [[nodiscard]] double sync_time_s(std::uint32_t tick) const { return 1.0 * tick * tick_period_us_ / 1e6; }

  [[nodiscard]] const std::vector<RecordedJoint>& joints() const { return joints_; }
  [[nodiscard]] const std::vector<std::string>& links() const { return links_; }
  /// Names of the objects of the environment that move.
  [[nodiscard]] const std::vector<std::string>& objects() const { return objects_; }
  [[nodiscard]] const std::vector<RecordedSlot>& slots() const { return slots_; }
  [[nodiscard]] const std::vector<RecordedInternalValue>& internal_values() const { return internal_values_; }
  [[nodiscard]] const std::vector<RecordedSensor>& sensors() const { return sensors_; }
  [[nodiscard]] std::vector<RecordedSetting> parameters() const;
  [[nodiscard]] std::vector<RecordedSetting> distortions() const;
  [[nodiscard]] std::vector<RecordedRestart> restarts() const;
  /// The moves by ascending tick; those of a tick in their order.
  [[nodiscard]] std::vector<RobotMove> moves() const;
  /// Whether the poses are those of a simulated world: `proleg drive` records the start of a robot that it cannot see.
  [[nodiscard]] bool has_world() const { return run_value("program") != "drive"; }
  /// The recorded hashes of the motion by ascending tick. Empty for an older recording, and without a simulated world.
  [[nodiscard]] std::vector<RecordedMotionHash> motion_hashes() const;
  /// The losses, summed over up to so many parts of the run of equal length; parts without losses are left out. Reads
  /// at most the first million losses.
  [[nodiscard]] std::vector<RecordedLosses> losses_in_parts(std::uint32_t parts) const;
  /// The faults by ascending start. Empty for a run without faults.
  [[nodiscard]] std::vector<RecordedFault> faults() const;
  /// The first tick in which something fails; nothing: none does. The gait can be recomputed up to it.
  [[nodiscard]] std::optional<std::uint32_t> first_fault_tick() const;
  /// Path and text of every file of the scenario.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> sources() const;

  /// Calls `use` for the ticks from `first` to `last`, in order. The next tick overwrites the object.
  void read_ticks(std::uint32_t first, std::uint32_t last, const std::function<void(const RecordedTick&)>& use) const;

 private:
  friend class LossReader;
  friend class ServoPulseReader;
  class Tables;

  [[nodiscard]] std::uint8_t joint_number(const Statement& row, int column) const;
  [[nodiscard]] std::uint32_t slot_number(const Statement& row, int column) const;
  void read_run();
  void read_robot();
  void read_slots();
  [[nodiscard]] std::vector<RecordedSetting> read_settings(const char* sql) const;

  std::filesystem::path path_;
  std::unique_ptr<Tables> tables_;
  bool finished_ = false;
  std::uint32_t tick_period_us_ = 0;
  std::uint32_t first_tick_ = 0;
  std::uint32_t last_tick_ = 0;
  std::vector<std::pair<std::string, std::string>> results_;
  std::vector<RecordedJoint> joints_;
  std::vector<std::string> links_;
  std::vector<std::string> objects_;
  std::vector<RecordedSlot> slots_;
  std::vector<RecordedInternalValue> internal_values_;
  std::vector<RecordedSensor> sensors_;
};

/// Reads the pulses of all servos one by one, in the order of time, then of joints. There is none while a module
/// restarts. A day has hundreds of millions of pulses. Throws as Recording does.
class ServoPulseReader {
 public:
  /// recording: must outlive the reader.
  explicit ServoPulseReader(const Recording& recording);
  ~ServoPulseReader();
  ServoPulseReader(const ServoPulseReader&) = delete;
  ServoPulseReader& operator=(const ServoPulseReader&) = delete;

  /// The next pulse, or nothing at the end.
  [[nodiscard]] std::optional<ServoPulse> next();

 private:
  const Recording& recording_;
  std::unique_ptr<Statement> row_;
};

/// Reads the losses one by one, in the order of tick, sender, channel, receiver. A day with many joints has hundreds of
/// millions. Throws as Recording does.
class LossReader {
 public:
  /// recording: must outlive the reader.
  explicit LossReader(const Recording& recording);
  ~LossReader();
  LossReader(const LossReader&) = delete;
  LossReader& operator=(const LossReader&) = delete;

  /// The next loss, or nothing at the end.
  [[nodiscard]] std::optional<Loss> next();

 private:
  const Recording& recording_;
  std::unique_ptr<Statement> row_;
};

/// "link 'Tail'" or "object 'ball'".
[[nodiscard]] std::string name_of(const MotionDifference& difference, const Recording& recording);

/// One line for the user if the run was interrupted or is still running; empty if it is finished.
[[nodiscard]] std::string remark_on_unfinished_run(const Recording& recording);

}  // namespace proleg::sim
