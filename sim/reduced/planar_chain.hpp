#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/reduced/chain_model.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::reduced {

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

/// A robot and its environment as the reduced engine sees them: a chain in a vertical plane. All numbers are whole
/// multiples of powers of two that are larger than rounding errors, so they are the same on every machine: lengths and
/// coefficients of 2^-30, moments of inertia of 2^-50.
struct PlanarChain : ChainModel {
  // Back to the world.
  MotionPlane plane;
  std::vector<double> joint_signs;                     ///< 1, or -1 where the axis of a joint points the other way
  std::vector<Eigen::Quaterniond> start_orientations;  ///< of the links, in the world
  std::vector<Eigen::Vector3d> mass_centers;           ///< in the frames of the links
  std::optional<double> lowest_ground;                 ///< m: of the whole environment, also beside the robot's way
};

/// Throws InputError if the engine does not have what the robot or the environment needs. file: that the message names.
[[nodiscard]] PlanarChain make_planar_chain(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                            const std::string& file);

}  // namespace proleg::sim::reduced
