#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/reduced/spatial_model.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::reduced {

/// A robot whose joints have any axes, and a level floor, as the reduced engine sees them. Numbers are rounded as those
/// of a PlanarChain.
struct SpatialChain : SpatialModel {
  std::vector<Eigen::Quaterniond> link_orientations;  ///< in the frame of the robot, at angles 0
  std::vector<Eigen::Vector3d> mass_centers;          ///< in the frames of the links
  std::optional<double> lowest_ground;                ///< m
};

/// Whether the joints have axes that make_planar_chain() cannot have: not all parallel, or not horizontal.
[[nodiscard]] bool needs_space(const RobotModel& robot, const EnvironmentModel& environment);

/// Throws InputError if the engine does not have what the robot or the environment needs. file: that the message names.
[[nodiscard]] SpatialChain make_spatial_chain(const RobotModel& robot, const EnvironmentModel& environment,
                                              double step_s, const std::string& file);

}  // namespace proleg::sim::reduced
