#pragma once

// What all modules of a robot must agree on, and the share of the bus that it takes.

#include <bit>
#include <cstdint>
#include <span>

#include "shared/canopen/messages.hpp"
#include "shared/fixed/crc32.hpp"
#include "shared/kernel/kernel.hpp"

namespace proleg::canopen {

/// The configuration that all modules of a robot must agree on.
struct RobotConfiguration {
  KernelConfiguration kernel;
  std::uint16_t robot_id = 1;
  std::uint32_t servo_period_us = 20'000;
  std::span<const std::uint8_t> nodes;  ///< node id of the module of each joint, in kernel order; all differ
};

/// The CRC that TICK contains, and that the host reads back after set-up. It is the CRC-32 (shared/fixed/crc32.hpp) of
/// these values, little-endian and without gaps: u8 joint count, u32 tick period, u32 servo period, u64 seed, u16 robot
/// id; for each of the four slots u8 algorithm id and u64 group, both 0 if the slot is empty; for each joint u8 node
/// id. Limits and start values are not part of it: they belong to one joint and change while the robot moves. A module
/// takes the nodes of the other joints from the identifiers of the state frames that it receives.
[[nodiscard]] inline std::uint32_t configuration_crc(const RobotConfiguration& robot) {
  Crc32 crc;
  crc.add_little_endian(robot.kernel.joint_count, 1);
  crc.add_little_endian(robot.kernel.tick_period_us, 4);
  crc.add_little_endian(robot.servo_period_us, 4);
  crc.add_little_endian(robot.kernel.seed, 8);
  crc.add_little_endian(robot.robot_id, 2);
  for (const Slot& slot : robot.kernel.slots) {
    crc.add_little_endian(slot.algorithm_id(), 1);
    crc.add_little_endian(slot.driven_joints().bits(), 8);
  }
  crc.add(robot.nodes);
  return crc.value();
}

/// Greatest share of the bus, in thousandths, that the frames of a robot may take in the worst case: a host refuses
/// others. The rest is for EMCY, SDO and the host.
inline constexpr std::uint32_t max_bus_load_permille = 850;

/// Share of a 1 Mbit/s bus, in thousandths and rounded up, that a robot's SYNC, state frames and monitoring take if
/// every frame has the most stuff bits: 135 bits for 8 bytes of data, 115 for 6 and 65 for one, with interframe space
/// (ISO 11898-1).
[[nodiscard]] inline std::uint32_t worst_bus_load_permille(const KernelConfiguration& kernel,
                                                           std::uint32_t monitoring_period) {
  const auto second_frames = static_cast<std::uint32_t>(std::popcount(kernel.second_channel_senders().bits()));
  constexpr std::uint32_t state_bits = 135;
  constexpr std::uint32_t sync_bits = 65;
  constexpr std::uint32_t tick_bits = 135;  // TICK is sent in every tenth tick
  constexpr std::uint32_t monitoring_bits = 115;
  const std::uint32_t bits = (kernel.joint_count + second_frames) * state_bits + sync_bits + (tick_bits + 9) / 10 +
                             (kernel.joint_count * monitoring_bits + monitoring_period - 1) / monitoring_period;
  // At 1 Mbit/s a bit is a microsecond.
  return (bits * 1000 + kernel.tick_period_us - 1) / kernel.tick_period_us;
}

/// The first of monitoring_periods, or the second if the first would exceed max_bus_load_permille.
[[nodiscard]] inline std::uint32_t monitoring_period(const KernelConfiguration& kernel) {
  const auto [usual, long_period] = monitoring_periods;
  return worst_bus_load_permille(kernel, usual) <= max_bus_load_permille ? usual : long_period;
}

[[nodiscard]] inline std::uint32_t worst_bus_load_permille(const KernelConfiguration& kernel) {
  return worst_bus_load_permille(kernel, monitoring_period(kernel));
}

}  // namespace proleg::canopen
