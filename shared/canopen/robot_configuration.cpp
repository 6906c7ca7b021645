#include "shared/canopen/robot_configuration.hpp"

#include "shared/fixed/crc32.hpp"

namespace proleg::canopen {

std::uint32_t configuration_crc(const RobotConfiguration& robot) {
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

}  // namespace proleg::canopen
