#pragma once

// The form of a chain, as plain arrays that code for any instruction set reads.

#include <cstddef>

namespace proleg::sim::reduced {

/// In the plane in which a chain moves: x along it, horizontal; z up. m.
struct Point {
  double x = 0.0;
  double z = 0.0;
  bool operator==(const Point&) const = default;
};

/// A rectangle.
struct Rectangle {
  Point center;
  Point along;               ///< unit vector along its sides of `length`
  double half_length = 0.0;  ///< m
  double half_height = 0.0;  ///< m, of the other sides
  bool operator==(const Rectangle&) const = default;
};

/// Points are from the link's centre of mass. The link lies in the plane as it does when all angles are 0.
struct LinkForm {
  Point front;    ///< the joint before it; of no meaning in the first link
  Point rear;     ///< the joint behind it; of no meaning in the last link
  Point forward;  ///< unit vector towards the front half, for the touch sensors; zero if there is one link
  Point down;     ///< unit vector out of the underside
  bool operator==(const LinkForm&) const = default;
};

/// Why a chain is lost.
inline constexpr double not_finite = 1.0;         ///< a position
inline constexpr double too_many_contacts = 2.0;  ///< than ChainCounts::contacts

/// The angle of a joint is that of the link behind it less that of the link before it.
struct JointForm {
  double lower = 0.0;  ///< rad
  double upper = 0.0;  ///< rad
  bool operator==(const JointForm&) const = default;
};

/// What of a link collides.
struct ShapeForm {
  std::size_t link = 0;
  Rectangle outline{};  ///< from the link's centre of mass
  double radius = 0.0;  ///< m, of a circle about the centre of mass that contains the outline
  bool operator==(const ShapeForm&) const = default;
};

/// How many of each thing a chain has.
struct ChainCounts {
  std::size_t links = 0;
  std::size_t joints = 0;
  std::size_t shapes = 0;
  std::size_t solids = 0;    ///< of the terrain
  std::size_t contacts = 0;  ///< at most at once
};

/// What all chains of a batch have in common.
struct ChainForm {
  ChainCounts counts;
  const LinkForm* links;    ///< from head to tail
  const JointForm* joints;  ///< joint j is between links j and j + 1
  const ShapeForm* shapes;  ///< by ascending link
  const Rectangle* terrain;
  bool self_collision;  ///< whether links that are not neighbours collide
  double step_s;
};

}  // namespace proleg::sim::reduced
