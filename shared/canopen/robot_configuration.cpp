#include "shared/canopen/robot_configuration.hpp"

#include "shared/fixed/crc32.hpp"

namespace proleg::canopen {
namespace {

void add_little_endian(Crc32& crc, std::uint64_t value, unsigned bytes) {
  for (unsigned i = 0; i < bytes; ++i) {
    crc.add(static_cast<std::uint8_t>(value >> (8U * i)));
  }
}

}  // namespace

std::uint32_t configuration_crc(const RobotConfiguration& robot) {
  Crc32 crc;
  add_little_endian(crc, robot.kernel.joint_count, 1);
  add_little_endian(crc, robot.kernel.tick_period_us, 4);
  add_little_endian(crc, robot.servo_period_us, 4);
  add_little_endian(crc, robot.kernel.seed, 8);
  add_little_endian(crc, robot.robot_id, 2);
  for (const Slot& slot : robot.kernel.slots) {
    add_little_endian(crc, slot.algorithm_id(), 1);
    add_little_endian(crc, slot.driven_joints().bits(), 8);
  }
  crc.add(robot.nodes);
  return crc.value();
}

}  // namespace proleg::canopen
