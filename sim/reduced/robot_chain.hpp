#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/reduced/chain_batch.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::reduced {

/// A robot and its environment as the reduced engine sees them. All numbers of the model are rounded(), so they are the
/// same on every computer: lengths and coefficients to 30 bits, moments of inertia to 50.
template <typename OfKind>
struct RobotChain : ChainModel<OfKind> {
  using Kind = OfKind;
  std::vector<double> joint_signs;  ///< 1, or -1 where the axis of a joint points the other way
  /// Orientations of the links at angles 0: in the world at the start (Planar), or in the frame of the robot (Spatial).
  std::vector<Eigen::Quaterniond> link_orientations;
  std::vector<Eigen::Vector3d> mass_centers;  ///< those of the links, in their frames
  std::optional<double> lowest_ground;        ///< m: of the whole environment, also beside the robot's way
};

/// The vertical plane in which a chain moves, in the world.
struct MotionPlane {
  Eigen::Vector3d x = Eigen::Vector3d::UnitX();       ///< unit vector, horizontal: x in the plane
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();  ///< unit vector, horizontal: about it, x turns away from z
  double offset = 0.0;                                ///< m: of the plane, along `across`

  [[nodiscard]] Point project(const Eigen::Vector3d& vector) const { return {vector.dot(x), vector.z()}; }
  [[nodiscard]] Eigen::Vector3d lift(const Point& point) const {
    return x * point.x + across * offset + Eigen::Vector3d(0.0, 0.0, point.z);
  }
};

struct PlanarChain : RobotChain<Planar> {
  MotionPlane plane;
};
using SpatialChain = RobotChain<Spatial>;

/// Whether the joints have axes that make_planar_chain() cannot have: not all parallel, or not horizontal.
[[nodiscard]] bool needs_space(const RobotModel& robot, const EnvironmentModel& environment);

// Both throw InputError if the engine does not have what the robot or the environment needs. file: the file that
// the message names.
[[nodiscard]] PlanarChain make_planar_chain(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                            const std::string& file);
[[nodiscard]] SpatialChain make_spatial_chain(const RobotModel& robot, const EnvironmentModel& environment,
                                              double step_s, const std::string& file);

/// What is computed from files becomes a whole multiple of 2^-bits, which is far above rounding errors.
inline double rounded(double value, int bits = 30) { return std::ldexp(std::round(std::ldexp(value, bits)), -bits); }

}  // namespace proleg::sim::reduced
