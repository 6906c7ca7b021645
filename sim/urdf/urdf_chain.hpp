#pragma once

// The chain that a robot in URDF is when its fixed joints are gone: what Proleg's robots are.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/urdf/urdf_robot.hpp"

namespace proleg::sim {

/// Links that fixed joints join to one body. Poses of its shapes, and its mass, are in the frame of the body: that of
/// the link whose name it has.
struct UrdfBody {
  struct Solid {
    UrdfShape shape;
    std::optional<double> friction;
  };
  std::string name;                    ///< of the first link from the root that has a mass or a shape
  Pose pose;                           ///< in the robot's frame at angles 0: y is forward, z up
  std::optional<MassProperties> mass;  ///< nothing: no link has one
  bool lacks_inertia = false;          ///< a link with a mass has none: it counts as a point
  std::vector<Solid> collisions;
  std::vector<UrdfShape> visuals;
  int line = 0;  ///< of that link
};

struct UrdfHinge {
  std::string name;
  std::size_t parent = 0;  ///< number of a body in the chain: towards the root of the file
  std::size_t child = 0;
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< in the frame of the child
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();   ///< in the frame of the child
  double lower = 0.0;                                ///< rad, not above 0
  double upper = 0.0;                                ///< rad, not below 0
  double effort = 0.0;                               ///< Nm; 0: not given
  double velocity = 0.0;                             ///< rad/s; 0: not given
  int line = 0;
};

struct UrdfChain {
  std::vector<UrdfBody> bodies;    ///< from the tail to the head
  std::vector<UrdfHinge> joints;   ///< from the tail to the head
  std::vector<std::string> notes;  ///< what was chosen, one line each
};

/// Merges the links at fixed joints, and orders the rest. The head is the end whose name ends with "head"; otherwise
/// the end that is farther forward; otherwise the one farther from the root. A continuous joint gets limits of half a
/// turn to each side. If the limits of a joint exclude 0, the angle in their middle becomes 0. Throws InputError for a
/// robot without a movable joint, with more than 64, or with branches.
[[nodiscard]] UrdfChain make_urdf_chain(const UrdfRobot& robot);

}  // namespace proleg::sim
