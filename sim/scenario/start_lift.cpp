#include "sim/scenario/start_lift.hpp"

#include <algorithm>
#include <optional>

#include "shared/computer/text/text.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/geometry_reader.hpp"
#include "sim/scenario/plausibility.hpp"

namespace proleg::sim {
namespace {

/// What is higher above the robot's lowest point, and not under its start position, is no ground but a wall: who starts
/// inside it gets a warning.
constexpr double highest_step = 0.5;  // m

/// How far the robot must be lifted so that none of its links is in the ground, and on which object it then rests.
struct Lift {
  double height = 0.0;  ///< m
  const StaticObject* ground = nullptr;
};

void raise(Lift& lift, double height, const StaticObject& object) {
  if (height > lift.height) {
    lift = {height, &object};
  }
}

/// Above all of each mesh that is under or over a link.
Lift lift_onto_meshes(const RobotModel& robot, const EnvironmentModel& environment) {
  Lift lift;
  for (const Link& link : robot.links) {
    const std::optional<Bounds> bounds = bounds_of(link.geometries, environment.robot_pose * link.pose);
    for (const StaticObject& object : environment.objects) {
      for (const Geometry& geometry : object.geometries) {
        if (bounds && geometry.mesh) {
          const std::optional<double> top = highest_over(*geometry.mesh, object.pose * geometry.pose,
                                                         bounds->lowest.head<2>(), bounds->highest.head<2>());
          raise(lift, top.value_or(bounds->lowest.z()) - bounds->lowest.z(), object);
        }
      }
    }
  }
  return lift;
}

std::optional<double> lowest_point(const RobotModel& robot, const Pose& start) {
  std::optional<double> lowest;
  for (const Link& link : robot.links) {
    if (const auto bounds = bounds_of(link.geometries, start * link.pose)) {
      lowest = std::min(lowest.value_or(bounds->lowest.z()), bounds->lowest.z());
    }
  }
  return lowest;
}

/// Of any link in a solid; at least 0.
double depth_in(const Geometry& solid, const Pose& body, const RobotModel& robot, const Pose& start) {
  double deepest = 0.0;
  for (const Link& link : robot.links) {
    deepest = std::max(deepest, overlap_depth(link.geometries, start * link.pose, solid, body));
  }
  return deepest;
}

/// A box one of whose axes is vertical, so that its highest point is its whole upper side.
bool is_level_box(const Geometry& geometry, const Pose& body) {
  constexpr double vertical = 1.0 - 1e-12;
  const Eigen::Matrix3d axes = (body * geometry.pose).orientation.toRotationMatrix();
  return geometry.shape == Shape::box && axes.row(2).cwiseAbs().maxCoeff() > vertical;
}

/// Onto the highest level box under the start position that a link is in. If there is nothing around or below the
/// robot, which would fall for ever, onto the lowest of what is above it.
Lift lift_onto_level_ground(const RobotModel& robot, const EnvironmentModel& environment) {
  const std::optional<double> bottom = lowest_point(robot, environment.robot_pose);
  if (!bottom) {
    return {};
  }
  Lift lift;
  Lift from_below;
  bool has_ground = false;
  for (const StaticObject& object : environment.objects) {
    for (const Geometry& geometry : object.geometries) {
      const Bounds bounds = bounds_of(geometry, object.pose);
      if (!contains_from_above(bounds, environment.robot_pose.position)) {
        continue;
      }
      const double height = bounds.highest.z() - *bottom;
      if (bounds.lowest.z() <= *bottom) {
        has_ground = true;
      } else if (from_below.ground == nullptr || height < from_below.height) {
        from_below = {height, &object};
      }
      if (is_level_box(geometry, object.pose) && depth_in(geometry, object.pose, robot, environment.robot_pose) > 0.0) {
        raise(lift, height, object);
      }
    }
  }
  return lift.ground == nullptr && !has_ground ? from_below : lift;
}

struct Overlap {
  double depth = 0.0;  ///< m
  const StaticObject* object = nullptr;
};

/// Of a link and a shape without a mesh that the robot can be lifted onto. highest: of its top, m.
Overlap deepest_overlap(const RobotModel& robot, const EnvironmentModel& environment, const Pose& start,
                        double highest) {
  Overlap deepest;
  for (const StaticObject& object : environment.objects) {
    for (const Geometry& solid : object.geometries) {
      const Bounds bounds = bounds_of(solid, object.pose);
      if (solid.mesh || (bounds.highest.z() > highest && !contains_from_above(bounds, start.position))) {
        continue;
      }
      if (const double depth = depth_in(solid, object.pose, robot, start); depth > deepest.depth) {
        deepest = {depth, &object};
      }
    }
  }
  return deepest;
}

/// Of an object that is oblique or round, and of one that only some links are in.
void lift_out_of_solids(const RobotModel& robot, const EnvironmentModel& environment, Lift& lift) {
  constexpr double rounding = 1e-9;   // m
  constexpr double min_step = 0.001;  // m
  constexpr int most_steps = 10'000;  // a thin wall needs many
  Pose start = environment.robot_pose;
  start.position.z() += lift.height;
  const std::optional<double> lowest = lowest_point(robot, start);
  if (!lowest) {
    return;
  }
  const double highest = *lowest + highest_step;
  Overlap overlap = deepest_overlap(robot, environment, start, highest);
  if (overlap.depth <= largest_start_depth) {
    return;
  }
  for (int step = 0; step < most_steps && overlap.depth > rounding; ++step) {
    const double height = std::max(overlap.depth, min_step);
    start.position.z() += height;
    lift = {lift.height + height, overlap.object};
    overlap = deepest_overlap(robot, environment, start, highest);
  }
}

}  // namespace

void lift_onto_ground(const RobotModel& robot, EnvironmentModel& environment, std::vector<std::string>& remarks) {
  Lift lift = lift_onto_level_ground(robot, environment);
  if (const Lift onto_mesh = lift_onto_meshes(robot, environment); onto_mesh.height > lift.height) {
    lift = onto_mesh;
  }
  lift_out_of_solids(robot, environment, lift);
  constexpr double min_lift = 1e-9;  // m
  if (lift.height < min_lift) {
    return;
  }
  environment.robot_pose.position.z() += lift.height;
  remarks.push_back(one_line("the robot starts " + number_text(lift.height * 1000.0) +
                             " mm higher than its start pose says, so that it rests on " +
                             in_quotes(lift.ground->name)));
}

}  // namespace proleg::sim
