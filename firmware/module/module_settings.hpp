#pragma once

#include "shared/canopen/objects.hpp"
#include "shared/canopen/robot_configuration.hpp"

namespace proleg::firmware {

/// The configuration of the robot as the host has written it. It takes effect at `activate`.
struct ModuleSettings {
  std::uint8_t joint = 0;
  std::uint8_t joint_count = canopen::object::joint_count.default_value;
  std::uint8_t front_node = 0;
  std::uint8_t rear_node = 0;
  std::uint16_t robot_id = canopen::object::robot_id.default_value;
  std::uint32_t tick_period_us = canopen::object::tick_period.default_value;
  std::uint32_t servo_period_us = canopen::object::servo_period.default_value;
  std::uint64_t seed = canopen::object::seed_low.default_value;
  std::array<std::uint8_t, max_slots> algorithms{};  ///< ids of algorithms; 0: the slot is empty
  std::array<std::uint64_t, max_slots> groups{};     ///< bit j: joint j
  /// For each channel and joint, the node that sends the joint's state frames; 0: none.
  std::array<std::array<std::uint8_t, max_joints>, max_channels> nodes{};

  [[nodiscard]] KernelConfiguration kernel() const;
  /// The CRC that all modules of the robot compute (canopen::configuration_crc).
  [[nodiscard]] std::uint32_t crc(std::uint8_t own_node) const;
};

}  // namespace proleg::firmware
