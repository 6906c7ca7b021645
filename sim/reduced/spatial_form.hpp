#pragma once

// The form of a chain with joints of any axis, as plain arrays that code for any instruction set reads. Directions are
// those at angles 0, in the frame of the robot; points are from the centre of mass of their link.

#include <cstddef>

#include "sim/reduced/chain_form.hpp"

namespace proleg::sim::reduced {

struct Point3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  bool operator==(const Point3&) const = default;
};

struct SpatialLinkForm {
  Point3 front;     ///< the joint before it; of no meaning in the first link
  Point3 rear;      ///< the joint behind it; of no meaning in the last link
  Point3 sideways;  ///< unit vector along the underside and across the link, for the touch sensors
  bool operator==(const SpatialLinkForm&) const = default;
};

struct SpatialJointForm {
  Point3 axis;  ///< unit vector: the angle turns the link behind about it, against the link before
  JointForm limits;
  bool operator==(const SpatialJointForm&) const = default;
};

/// Of a box that collides.
struct CornerForm {
  Point3 point;
  int sensor = 0;  ///< that it presses: 1 rear, 2 front, 0 none
  bool operator==(const CornerForm&) const = default;
};

inline constexpr std::size_t corners_of_box = 8;
inline constexpr std::size_t max_spatial_joints = 64;

/// A box that collides.
struct BoxForm {
  std::size_t link = 0;
  Point3 center;
  Point3 sides[3];      ///< from the centre to the middle of a side; at right angles
  double radius = 0.0;  ///< m, of a sphere about the link's centre of mass that contains the box
  CornerForm corners[corners_of_box];
  bool operator==(const BoxForm&) const = default;
};

/// A level floor: what is in its box and below its top is pushed up.
struct FloorForm {
  Point3 center;  ///< of its top, in the world
  Point3 along;   ///< unit vector, horizontal
  double half_length = 0.0;
  double half_width = 0.0;
  double thickness = 0.0;  ///< 0: there is no floor
  bool operator==(const FloorForm&) const = default;
};

struct SpatialCounts {
  std::size_t links = 0;
  std::size_t joints = 0;
  std::size_t boxes = 0;
  std::size_t contacts = 0;  ///< at most at once
};

/// What all chains of a batch have in common.
struct SpatialForm {
  SpatialCounts counts;
  const SpatialLinkForm* links;
  const SpatialJointForm* joints;  ///< joint j is between links j and j + 1
  const BoxForm* boxes;            ///< by ascending link
  FloorForm floor;
  bool self_collision;  ///< whether links that are not neighbours must not touch
  double step_s;
};

}  // namespace proleg::sim::reduced
