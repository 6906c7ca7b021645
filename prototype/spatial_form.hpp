#pragma once

#include <cstddef>

#include "prototype/space.hpp"

namespace proleg::sim::reduced {

constexpr std::size_t max_links = 8;
constexpr std::size_t max_joints = max_links - 1;
constexpr std::size_t max_corners = 8 * max_links;

/// All directions as they are when all angles are 0; points from the link's centre of mass.
struct SpatialForm {
  std::size_t links = 0, joints = 0, shapes = 0;
  Point3 front[max_links];  ///< the joint before a link
  Point3 rear[max_links];
  Point3 axis[max_joints];  ///< the angle turns link j + 1 about it against link j
  double lower[max_joints], upper[max_joints];
  std::size_t shape_link[max_links];
  Point3 corner[max_corners];  ///< by shape: 8
  double step_s = 0.001;
};

/// Of the worlds of a vector.
template <int width>
struct SpatialMemory {
  using Number = typename Lanes<width>::Number;
  using Vector = Space<Number>;
  // Constants.
  Number mass[max_links], inverse_mass;
  Vector inertia[max_links];  ///< principal, along the axes at angles 0
  Number friction[max_links];  ///< by shape
  Number gravity;
  // Servos.
  Number wanted_speed[max_joints], max_torque[max_joints], is_free[max_joints];
  // State.
  Vector center, center_speed;
  Number orientation[4];  ///< of the first link
  Number joint_angle[max_joints];
  Vector link_speed[max_links];  ///< less that of the centre
  Vector spin_momentum[max_links];
  Number normal_impulse[max_corners], friction_x[max_corners], friction_y[max_corners];
  // Results.
  Number motor_torque[max_joints];
  Number contact_count;
};

struct SpatialStatistics {
  double steps = 0, contacts_in_union = 0, contacts = 0, weak = 0, weak_rounds = 0;
};

struct SpatialKernel {
  const char* name;
  int width;
  std::size_t memory_size;
  unsigned (*step_strong)(const SpatialForm&, void*, SpatialStatistics&);
  void (*step_weak)(const SpatialForm&, void*, SpatialStatistics&);
};

}  // namespace proleg::sim::reduced
