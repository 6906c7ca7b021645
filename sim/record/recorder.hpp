#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/record/recorded_run.hpp"
#include "sim/record/recording_file.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The result of tick k, after it was computed and simulated until SYNC k + 1. Joints and links count from the head.
struct TickSample {
  std::uint32_t tick = 0;  ///< k
  /// Per link, bit 0 rear, bit 1 front sensor; given to the kernel at k.
  std::span<const std::uint8_t> latched_contacts{};
  std::span<const std::int32_t> setpoints{};  ///< per joint: out(k + 1)
  /// State k + 1: slot by slot, in each the joints of its group, of each joint all values.
  std::span<const std::int32_t> internal_values{};
  std::span<const ServoPulse> servo_pulses{};      ///< that start in the tick, in the order of time, then of joints
  std::span<const std::int32_t> servo_commands{};  ///< per joint: the last pulse before SYNC k + 1
  std::span<const Pose> link_poses{};              ///< in the world, at SYNC k + 1
  std::span<const double> joint_angles{};          ///< rad, at SYNC k + 1, measured on the robot
  std::span<const double> motor_torques{};         ///< Nm, means over the tick
  std::span<const double> servo_currents{};        ///< mA, means over the tick
  std::span<const double> contact_forces{};        ///< per link: N, normal forces of its contacts, means over the tick
  std::span<const Loss> lost{};                    ///< frames labelled k that their receivers did not get
  std::span<const RobotMove> moves{};              ///< that took effect at k
  std::span<const Pose> object_poses{};            ///< of the objects that move, in the world, at SYNC k + 1
  /// At SYNC k + 1, of each sensor of the robot's file all channels. measured_sensors: per sensor, 0 if its values are
  /// older.
  std::span<const double> sensor_values{};
  std::span<const std::uint8_t> measured_sensors{};
  std::span<const JointReadings> readings{};  ///< per joint, given to the kernels at k; empty: no algorithm reads them
  bool has_world = false;                     ///< the poses are those of a simulated world
};

/// Writes a run into an SQLite file (tables: schema.hpp) while it runs. Other programs may read the file at the same
/// time.
///
/// If the process is killed, the file lacks at most the last second: record_tick commits rows that have waited for half
/// a second. (A program that runs on without recording can lose the half second before its last record_tick.)
///
/// Throws FileError if it cannot write; after that it rejects all further calls.
class Recorder {
 public:
  /// Creates the file, as RecordingClaim does. scenario: must outlive the recorder. program: what computes the gait,
  /// e.g. "simulate" or "hil native". build_id: of the program.
  Recorder(const std::filesystem::path& path, const Scenario& scenario, const std::string& program,
           const std::string& build_id, EarlierFile earlier = EarlierFile::is_replaced);
  /// Commits. A run without finish() remains marked as unfinished. Writes an error to standard error.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// A change that takes effect at its tick. Call this before the record_tick of that tick.
  void record_change(const Change& change);
  /// From this tick on the module of a joint computes nothing (it restarts), or computes again (it joined). Call this
  /// before the record_tick of that tick.
  void record_restart(std::uint32_t tick, std::uint32_t joint, bool joined);
  /// What is made to fail in the run. Call this before the first record_tick.
  void record_faults(std::span<const RecordedFault> faults);
  /// What a module did in a run with faults, in microseconds after SYNC 0.
  void record_module_event(std::uint64_t time_us, std::uint32_t joint, const std::string& text);
  /// Ticks must ascend. Throws FileError if a value is not finite, because the simulation became unstable.
  void record_tick(const TickSample& sample);
  /// Marks the run as finished and closes the file, so that the recording is one file. summary: names and values for
  /// the table `result`.
  void finish(const std::vector<std::pair<std::string, std::string>>& summary);

 private:
  class Storage;
  std::unique_ptr<RecordingClaim> claim_;  ///< until the file is closed
  std::unique_ptr<Storage> storage_;
};

}  // namespace proleg::sim
