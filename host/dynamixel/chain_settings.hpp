#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/robot_control_abi/robot_control.h"

namespace proleg::host {

/// A parameter of the robot's file is wrong. what(): "found ..., expected ...".
class SettingError : public std::runtime_error {
 public:
  SettingError(std::uint32_t line, const std::string& found, const std::string& expected)
      : std::runtime_error("found " + found + ", expected " + expected), line_(line) {}
  /// Line of the robot's file; 0: the error belongs to no line.
  [[nodiscard]] std::uint32_t line() const { return line_; }

 private:
  std::uint32_t line_;
};

/// The servo of a joint. Joint angle a (degrees) is position 2048 + (direction * a + offset) * 4096 / 360.
struct ServoSettings {
  std::string joint;  ///< name of the joint
  std::uint8_t id = 1;
  bool is_reversed = false;  ///< whether the direction is -1
  double offset_deg = 0.0;   ///< angle of the servo when the joint is at 0 degrees
  double lower_limit_deg = -90.0;
  double upper_limit_deg = 90.0;
  double max_speed_deg_s = 360.0;

  /// The nearest position for a joint angle; ties are rounded up. Angles may be up to +-1000 degrees.
  [[nodiscard]] std::int32_t position_of(double joint_deg) const;
  /// The joint angle of a position, in degrees.
  [[nodiscard]] double angle_of(std::int32_t position) const;
};

struct ChainSettings {
  std::string device;
  unsigned rate = 57'600;
  std::uint32_t tick_us = 10'000;
  unsigned watchdog = 10;  ///< Bus Watchdog(98), in 20 ms
  std::vector<ServoSettings> servos;
};

/// Reads the parameters (docs/robot-control.md lists them) and checks that the line can carry a goal position of all
/// servos and an answer of one in each tick. Throws SettingError.
[[nodiscard]] ChainSettings read_chain_settings(const proleg_setup& setup);

/// Time in us that this number of bytes takes on the line: 8 data bits, start and stop bit.
[[nodiscard]] std::uint32_t line_time_us(std::size_t bytes, unsigned rate);

/// Bytes of the packet with goal positions of all servos.
[[nodiscard]] std::size_t goal_packet_size(std::size_t servos);

/// Time in us from the start of a tick to the end of its reads. A tenth of the tick stays free for the host's own
/// delays.
[[nodiscard]] constexpr std::uint64_t tick_time_for_reads_us(std::uint32_t tick_us) {
  return std::uint64_t{tick_us} * 9 / 10;
}

/// Time in us that a read of this number of servos takes behind an adapter with low latency. return_delay_us: the
/// greatest return delay of the servos.
[[nodiscard]] std::uint32_t expected_read_time_us(std::size_t servos, unsigned rate, std::uint32_t return_delay_us);

/// Number of servos that can be read in each tick after their goal positions were sent; at most `servos`.
[[nodiscard]] std::size_t readable_servos(std::size_t servos, unsigned rate, std::uint32_t tick_us,
                                          std::uint32_t return_delay_us);

}  // namespace proleg::host
