#pragma once

#include <cstdint>
#include <span>

#include "shared/kernel/kernel.hpp"

namespace proleg::canopen {

/// The configuration that all modules of a robot must agree on.
struct RobotConfiguration {
  KernelConfiguration kernel;
  std::uint16_t robot_id = 1;
  std::uint32_t servo_period_us = 20'000;
  std::span<const std::uint8_t> nodes;  ///< node id of the module of each joint, in kernel order; all differ
};

/// The CRC that TICK contains, and that the host reads back after set-up. It is the CRC-32 (shared/fixed/crc32.hpp) of,
/// little-endian and without gaps: u8 joint count, u32 tick period, u32 servo period, u64 seed, u16 robot id; for each
/// of the four slots u8 algorithm id and u64 group, both 0 if the slot is empty; for each joint u8 node id. Limits and
/// start values are not part of it: they belong to one joint and change while the robot moves. A module knows the nodes
/// of the other joints from the identifiers of the state frames that it receives.
[[nodiscard]] std::uint32_t configuration_crc(const RobotConfiguration& robot);

}  // namespace proleg::canopen
