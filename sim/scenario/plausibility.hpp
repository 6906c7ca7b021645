#pragma once

// Finds what is valid in a scenario and probably not meant: a joint far from its links, links at the same place,
// gravity that points upwards, heights in millimetres, a start inside a wall, ground that faces downwards. Each warning
// is one line: file, line, what is there, and the usual cause.

#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/scenario/chain.hpp"

namespace proleg::sim {

/// Warnings on the geometry and the masses of a robot.
[[nodiscard]] std::vector<std::string> check_robot(const Chain& chain);

/// A warning on links that are no neighbours and overlap by more than a tenth of their size at angles 0. It holds where
/// they collide: a contact that deep pushes them apart at once.
[[nodiscard]] std::vector<std::string> check_overlaps(const Chain& chain);

/// A warning on gravity (m/s^2) that does not hold a robot on the ground. origin: where it is given.
[[nodiscard]] std::vector<std::string> check_gravity(const Eigen::Vector3d& gravity, const Origin& origin);

/// A warning on heights in another unit than the sides of their field, or far from all others. origin: of the body.
[[nodiscard]] std::vector<std::string> check_heights(const HeightField& field, const Origin& origin);

/// A robot that lies on the ground may be in it by this, in m.
inline constexpr double largest_start_depth = 0.003;

/// How far two solids are in each other, in m: the shortest way out along an axis of one of them. Not above 0 if they
/// are apart along one. Cylinders and hulls count as the boxes around them. If `right` is a mesh or a height
/// field, it is how far the box around `left` must be lifted to be above all of it. Poses are those of the bodies in
/// the world.
[[nodiscard]] double overlap_depth(const Geometry& left, const Pose& left_body, const Geometry& right,
                                   const Pose& right_body);
/// The greatest depth in `right` of any geometry of a body; 0 if none is in it.
[[nodiscard]] double overlap_depth(const std::vector<Geometry>& left, const Pose& left_body, const Geometry& right,
                                   const Pose& right_body);

/// Warnings on links that start inside an object, and on surfaces under links that face downwards: a mesh touches only
/// what is on the side that its triangles face. environment_file: the file that gives the start pose.
[[nodiscard]] std::vector<std::string> check_start(const std::vector<Link>& links, const EnvironmentModel& environment,
                                                   const std::string& environment_file);

}  // namespace proleg::sim
