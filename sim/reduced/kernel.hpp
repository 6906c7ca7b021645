#pragma once

// The two kinds of chains, their form as plain arrays that code for any instruction set reads, and the kernels that
// step them. Planar and Spatial have only types and constants: a function here would be compiled for each instruction
// set, and the linker would choose one of them (chain_step.hpp).

#include <cstddef>

namespace proleg::sim::reduced {

/// A point or a direction in the plane in which a chain moves: x along it, horizontal; z up. m.
struct Point {
  double x = 0.0;
  double z = 0.0;
  bool operator==(const Point&) const = default;
};

/// A point or a direction in space. m.
struct Point3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  bool operator==(const Point3&) const = default;
};

struct Rectangle {
  Point center;
  Point along;               ///< unit vector along its sides of `length`
  double half_length = 0.0;  ///< m
  double half_height = 0.0;  ///< m, along the other sides
  bool operator==(const Rectangle&) const = default;
};

/// The stops of a joint.
struct JointLimits {
  double lower = 0.0;  ///< rad
  double upper = 0.0;  ///< rad
  bool operator==(const JointLimits&) const = default;
};

/// Chains whose joints have parallel, horizontal axes: they move in a vertical plane, on any rectangles. The angle of a
/// joint is that of the link behind it less that of the link before it.
struct Planar {
  static constexpr std::size_t axes = 2;                 ///< numbers of a point or a velocity: x and z
  static constexpr std::size_t spin_axes = 1;            ///< numbers of an angular velocity
  static constexpr std::size_t inertia_numbers = 1;      ///< the moment of inertia about an axis across the plane
  static constexpr std::size_t orientation_numbers = 1;  ///< angle of the first link, rad
  static constexpr double unturned = 0.0;  ///< the first number of the orientation that is no rotation; others are 0
  // Two convex outlines touch in at most two points. More than three such pairs for a shape are no crawling robot.
  static constexpr std::size_t contacts_of_shape = 6;
  static constexpr std::size_t more_contacts = 4;
  static constexpr double contact_keys = 8.0;  ///< keys that a pair of shapes that touch has

  using Point = reduced::Point;
  /// Points are from the link's centre of mass. The link lies in the plane as it does when all angles are 0.
  struct Link {
    Point front;    ///< the joint before it; of no meaning in the first link
    Point rear;     ///< the joint behind it; of no meaning in the last link
    Point forward;  ///< unit vector towards the front half, for the touch sensors; zero if there is one link
    Point down;     ///< unit vector out of the underside
    bool operator==(const Link&) const = default;
  };
  using Joint = JointLimits;
  /// A part of a link that collides.
  struct Shape {
    std::size_t link = 0;
    Rectangle outline{};  ///< from the link's centre of mass
    double radius = 0.0;  ///< m, of a circle about the centre of mass that contains the outline
    bool operator==(const Shape&) const = default;
  };
  /// A part of the terrain.
  using Solid = Rectangle;

  /// Where a link is.
  struct LinkPlace {
    Point position;      ///< its centre of mass, m
    double half_sine;    ///< sine of half the angle by which it has turned since all angles were 0
    double half_cosine;  ///< cosine of the same angle
  };
  struct LinkMotion {
    Point velocity;   ///< velocity of its centre of mass, m/s
    double rotation;  ///< rad/s
  };
};

/// Chains with joints of any axis, on a level floor. Directions are those at angles 0, in the frame of the robot;
/// points are from the centre of mass of their link.
struct Spatial {
  static constexpr std::size_t axes = 3;
  static constexpr std::size_t spin_axes = 3;
  static constexpr std::size_t inertia_numbers = 6;      ///< xx, yy, zz, xy, xz, yz, along the axes at angles 0
  static constexpr std::size_t orientation_numbers = 4;  ///< quaternion of the first link: w, x, y, z
  static constexpr double unturned = 1.0;
  static constexpr std::size_t corners_of_shape = 8;
  static constexpr std::size_t contacts_of_shape = corners_of_shape;
  static constexpr std::size_t more_contacts = 0;
  static constexpr double contact_keys = 1.0;  ///< keys that a corner has
  static constexpr std::size_t max_joints = 64;

  using Point = Point3;
  struct Link {
    Point front;     ///< the joint before it; of no meaning in the first link
    Point rear;      ///< the joint behind it; of no meaning in the last link
    Point sideways;  ///< unit vector along the underside and across the link, for the touch sensors
    bool operator==(const Link&) const = default;
  };
  struct Joint : JointLimits {
    Point axis;  ///< unit vector: the angle turns the link behind about it, against the link before
    bool operator==(const Joint&) const = default;
  };
  struct Corner {
    Point point;
    int sensor = 0;  ///< the sensor that it presses: 1 rear, 2 front, 0 none
    bool operator==(const Corner&) const = default;
  };
  /// A box that collides.
  struct Shape {
    std::size_t link = 0;
    Point center;
    Point sides[3];       ///< from the centre to the middle of a side; at right angles
    double radius = 0.0;  ///< m, of a sphere about the link's centre of mass that contains the box
    Corner corners[corners_of_shape];
    bool operator==(const Shape&) const = default;
  };
  /// The level floor, of which there is at most one. It pushes up what is in its box and below its top.
  struct Solid {
    Point center;  ///< centre of its top, in the world
    Point along;   ///< unit vector, horizontal
    double half_length = 0.0;
    double half_width = 0.0;
    double thickness = 0.0;
    bool operator==(const Solid&) const = default;
  };

  /// Where a link is.
  struct LinkPlace {
    Point position;  ///< its centre of mass, m
    Point axes[3];   ///< where the axes of the robot's frame, that it had at angles 0, point now
  };
  struct LinkMotion {
    Point velocity;          ///< velocity of its centre of mass, m/s
    Point rotation;          ///< rad/s
    Point angular_momentum;  ///< about its centre of mass, kg m^2/s
  };
};

// Why a chain is lost.
inline constexpr double not_finite = 1.0;         ///< a position is no finite number
inline constexpr double too_many_contacts = 2.0;  ///< there are more than ChainCounts::contacts

/// How many of each thing a chain has.
struct ChainCounts {
  std::size_t links = 0;
  std::size_t joints = 0;
  std::size_t shapes = 0;
  std::size_t solids = 0;
  std::size_t pairs = 0;     ///< things that touch with a friction of their own (ChainModel::friction)
  std::size_t contacts = 0;  ///< the most at once
};

/// What all chains of a batch have in common.
template <typename Kind>
struct ChainForm {
  ChainCounts counts;
  const typename Kind::Link* links;    ///< from head to tail
  const typename Kind::Joint* joints;  ///< joint j is between links j and j + 1
  const typename Kind::Shape* shapes;  ///< in the order of their links
  const typename Kind::Solid* solids;  ///< the terrain
  bool self_collision;  ///< links that are not neighbours collide (Planar), or must not touch each other (Spatial)
  double step_s;
};

/// What a kernel does to chains of a kind: the chains of a block, one in each lane of a vector. The block is a
/// ChainMemory, `scratch` a ChainScratch, both aligned to 64 bytes.
template <typename Kind>
struct KernelSteps {
  unsigned (*step_strong)(const ChainForm<Kind>& form, double* block, double* scratch);  ///< ChainStep::step_strong()
  void (*step_weak)(const ChainForm<Kind>& form, double* block, double* scratch);        ///< ChainStep::step_weak()
  void (*place)(const ChainForm<Kind>& form, double* block, double* scratch);            ///< ChainStep::place_links()
};

/// The code of the engine for one kind of processor. All kernels give the same bits.
struct ChainKernel : KernelSteps<Planar>, KernelSteps<Spatial> {
  const char* instructions;  ///< e.g. "AVX2"
  int width;                 ///< chains in a block
};

/// The kernel for every processor.
extern const ChainKernel base_kernel;
#ifdef __x86_64__
extern const ChainKernel avx2_kernel;
extern const ChainKernel avx512_kernel;
#endif

}  // namespace proleg::sim::reduced
