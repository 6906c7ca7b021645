#include "firmware/module/module_settings.hpp"

#include "shared/gait/registry.hpp"

namespace proleg::firmware {

KernelConfiguration ModuleSettings::kernel() const {
  KernelConfiguration configuration;
  configuration.joint_count = joint_count;
  configuration.tick_period_us = tick_period_us;
  configuration.seed = seed;
  for (std::size_t slot = 0; slot < max_slots; ++slot) {
    if (algorithms[slot] != 0) {
      configuration.slots[slot] = {find_algorithm(algorithms[slot]), JointMask(groups[slot])};
    }
  }
  return configuration;
}

std::uint32_t ModuleSettings::crc(std::uint8_t own_node) const {
  std::array<std::uint8_t, max_joints> robot = nodes[0];
  robot[joint] = own_node;
  return canopen::configuration_crc({kernel(), robot_id, servo_period_us, {robot.data(), joint_count}});
}

}  // namespace proleg::firmware
