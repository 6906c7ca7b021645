#pragma once

#include <cmath>
#include <cstdint>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// Which way a joint bends the robot that lies as in its file.
enum class JointDirection : std::uint8_t {
  pitch,  ///< up and down: its axis is rather horizontal
  yaw,    ///< to the sides: its axis is rather vertical
};

[[nodiscard]] inline JointDirection direction_of(const Joint& joint) {
  constexpr double cosine_of_45_degrees = 0.7071;
  return std::abs(joint.axis.z()) > cosine_of_45_degrees ? JointDirection::yaw : JointDirection::pitch;
}

}  // namespace proleg::sim
