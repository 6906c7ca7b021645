#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/file_error.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/servo_pulse.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What is known after tick k was computed and simulated until SYNC k + 1. Joints and links count from the head.
struct TickSample {
  std::uint32_t tick;  ///< k
  std::span<const std::uint8_t>
      latched_contacts;                     ///< per link bit 0 rear, bit 1 front sensor; given to the kernel at k
  std::span<const std::int32_t> setpoints;  ///< per joint: out(k + 1)
  /// State k + 1: slot by slot, in each the joints of its group, of each joint all values.
  std::span<const std::int32_t> internal_values;
  std::span<const ServoPulse> servo_pulses;      ///< that start in the tick, in the order of time, then of joints
  std::span<const std::int32_t> servo_commands;  ///< per joint: the last pulse before SYNC k + 1
  std::span<const Pose> link_poses;              ///< in the world, at SYNC k + 1
  std::span<const double> joint_angles;          ///< rad, at SYNC k + 1, measured on the robot
  std::span<const Loss> lost;                    ///< frames labelled k that were kept from their receivers
};

/// Writes a run into an SQLite file (tables: schema.hpp) as it goes on. Others may read the file at the same time.
///
/// When the process is killed, what was recorded up to a second before is in the file: what waits for longer than half
/// a second is committed by the next record_tick. (A program that stops recording for a while, alive but silent, can
/// lose the half second before its silence.)
///
/// Every failure to write is thrown as FileError; after one, the recorder takes nothing more.
class Recorder {
 public:
  /// Creates the file. It must not be there yet, unless it is empty or an earlier recording, which is then replaced.
  /// scenario: must outlive the recorder. program: what computes the gait, e.g. "simulate" or "hil native".
  /// build_id: of the program.
  Recorder(const std::filesystem::path& path, const Scenario& scenario, const std::string& program,
           const std::string& build_id);
  /// Commits. A run that was not finished stays marked so. A failure, which cannot be thrown here, goes to standard
  /// error.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// A change that takes effect at its tick; call it before the record_tick of that tick.
  void record_change(const Change& change);
  /// The module of a joint does not compute this tick and those that follow (it restarts), or computes again from this
  /// tick on; call it before the record_tick of that tick.
  void record_restart(std::uint32_t tick, std::uint32_t joint, bool joined);
  /// Ticks come in ascending order. All values must be finite: a simulation that has blown up is an error here.
  void record_tick(const TickSample& sample);
  /// Marks the run as finished and closes the file, one file then. summary: names and values for the table `result`.
  void finish(const std::vector<std::pair<std::string, std::string>>& summary);

 private:
  class Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace proleg::sim
