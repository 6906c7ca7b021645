#pragma once

// What a recording keeps of a run.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/fixed/unit.hpp"
#include "shared/gait/joint_readings.hpp"
#include "shared/kernel/kernel.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

struct RecordedJoint {
  std::string name;
  std::size_t file_index = 0;
  std::int32_t lower_limit = 0;  ///< 90 degrees = 2^30
  std::int32_t upper_limit = 0;
};

struct RecordedSlot {
  std::uint32_t slot = 0;
  std::string algorithm;
  std::vector<bool> joint_group;  ///< for each joint, the head's first
};

/// An internal value of one joint.
struct RecordedInternalValue {
  std::uint32_t slot = 0;
  std::uint32_t joint = 0;
  std::uint32_t number = 0;  ///< of the value in the declaration of the slot's algorithm
  std::string name;
  Unit unit = Unit::count;
};

/// A parameter at the start or after a commit, or an internal value that was overwritten.
struct RecordedSetting {
  std::uint32_t tick = 0;
  bool commit = false;  ///< whether the change took effect at the SYNC of its tick, not from the start
  std::uint32_t slot = 0;
  std::uint32_t joint = 0;
  std::string name;
  Unit unit = Unit::count;
  std::int32_t raw = 0;
};

/// A sensor that the robot's file attaches.
struct RecordedSensor {
  struct Channel {
    std::string name;
    std::string unit;
  };
  std::string name;
  SensorKind kind = SensorKind::touch;
  std::uint32_t part = 0;  ///< link, of a servo_current the joint; from the head
  std::vector<Channel> channels;
  std::size_t first_value = 0;  ///< position of the first channel in RecordedTick::sensor_values
};

/// A module that restarted.
struct RecordedRestart {
  std::uint32_t tick = 0;
  std::uint32_t joint = 0;
  bool joined = false;  ///< computes again from this tick on; otherwise: computes nothing from this tick on
};

/// Frames that were lost in a part of the run.
struct RecordedLosses {
  std::uint32_t tick = 0;    ///< the first tick
  std::uint64_t frames = 0;  ///< a frame counts once for each joint that did not receive it
};

/// What was computed at SYNC `tick` and holds at SYNC tick + 1, and the contacts from which it was computed. Joints and
/// links from the head.
struct RecordedTick {
  std::uint32_t tick = 0;
  std::vector<std::int32_t> setpoints;         ///< 90 degrees = 2^30
  std::vector<std::int32_t> servo_commands;    ///< twelfths of a microsecond
  std::vector<double> joint_angles;            ///< rad
  std::vector<double> motor_torques;           ///< Nm, mean over the tick
  std::vector<double> servo_currents;          ///< mA, mean over the tick
  std::vector<std::int32_t> internal_values;   ///< in the order of Recording::internal_values()
  std::vector<Pose> link_poses;                ///< in the world
  std::vector<std::uint8_t> latched_contacts;  ///< at SYNC tick; bit 0 rear, bit 1 front sensor
  std::vector<double> contact_forces;          ///< N, of each link, mean over the tick
  std::vector<Pose> object_poses;              ///< of each object that moves, in the world
  std::vector<JointReadings> readings;         ///< by joint, given to its algorithms at SYNC tick
  std::vector<double> sensor_values;           ///< of all sensors, all channels; of a laser those of its last scan
};

/// Something that was made to fail. Times in microseconds after SYNC 0.
struct RecordedFault {
  std::uint64_t start_us = 0;
  std::optional<std::uint64_t> end_us;  ///< nothing: to the end of the run, or it happens once
  std::optional<std::uint32_t> joint;   ///< whose module it befalls; nothing: the whole robot
  std::string text;                     ///< as in a fault schedule
};

// The order of internal values in recordings: slot by slot, in each the joints of its group, of each joint all values.

/// Calls use(joint, number) for every internal value of one slot. value_count: number of values of each joint.
template <typename Use>
void for_each_internal_value_of_slot(unsigned joint_count, JointMask group, std::uint32_t value_count, const Use& use) {
  for (unsigned joint = 0; joint < joint_count; ++joint) {
    for (std::uint32_t number = 0; group.contains(joint) && number < value_count; ++number) {
      use(joint, number);
    }
  }
}

/// Calls use(slot, joint, number) for every internal value of a robot.
template <typename Use>
void for_each_internal_value(const KernelConfiguration& configuration, const Use& use) {
  for (unsigned number = 0; number < max_slots; ++number) {
    const Slot& slot = configuration.slots[number];
    if (slot.algorithm == nullptr) {
      continue;
    }
    const auto count = static_cast<std::uint32_t>(slot.algorithm->declaration().internal_values.size());
    for_each_internal_value_of_slot(configuration.joint_count, slot.group, count,
                                    [&](unsigned joint, unsigned value) { use(number, joint, value); });
  }
}

}  // namespace proleg::sim
