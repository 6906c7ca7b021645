#pragma once

// The environment of `proleg new obstacle`: a floor with hills and pits across the way of the robot, like the irregular
// obstacle of the thesis (figure 6.7), whose dimensions it does not print.

#include <string>
#include <vector>

namespace proleg::tools {

struct Obstacle {
  /// Height of each hill above the floor in mm, in the order in which the robot meets them; a pit is below 0. The
  /// defaults are those of the shipped obstacle: two hills, the pit between them and the last hill, a last one.
  std::vector<double> heights_mm{32, 43, -43, 43};
  double length_mm = 400;  ///< of each hill along the way of the robot
  double start_mm = 360;   ///< of the first hill, from the position of the robot
  double width_mm = 2'000;
  unsigned segments = 10;  ///< flat pieces of each hill
  double friction = 0.6;   ///< of the hills
  double floor_friction = 0.1;
};

/// The environment file. Each hill is a wave of a cosine, made of flat boxes: any engine has boxes.
[[nodiscard]] std::string obstacle_text(const Obstacle& obstacle);

}  // namespace proleg::tools
