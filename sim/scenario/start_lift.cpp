#include "sim/scenario/start_lift.hpp"

#include <algorithm>
#include <optional>

#include "shared/computer/text/text.hpp"
#include "sim/robot/mesh_height.hpp"
#include "sim/scenario/geometry_reader.hpp"
#include "sim/scenario/plausibility.hpp"

namespace proleg::sim {
namespace {

/// What is higher above the robot's lowest point is no ground but a wall: who starts inside it gets a warning.
constexpr double highest_step = 0.5;  // m

/// Bounds of all geometries of a body; nothing if there are none.
std::optional<Bounds> bounds_of_body(const std::vector<Geometry>& geometries, const Pose& frame) {
  std::optional<Bounds> whole;
  for (const Geometry& geometry : geometries) {
    const Bounds bounds = bounds_of(geometry, frame);
    whole = whole ? Bounds{whole->lowest.cwiseMin(bounds.lowest), whole->highest.cwiseMax(bounds.highest)} : bounds;
  }
  return whole;
}

/// How far the robot must be lifted so that none of its links is in the ground, and on which object it then rests. A
/// shape without a mesh counts as high as its highest point if it is under the start, and as it is where a link is in
/// it; a mesh counts as it is under each link.
struct Lift {
  double height = 0.0;  ///< m
  const StaticObject* ground = nullptr;
};

void raise(Lift& lift, double height, const StaticObject& object) {
  if (height > lift.height) {
    lift = {height, &object};
  }
}

Lift lift_of_links(const RobotModel& robot, const EnvironmentModel& environment) {
  Lift lift;
  for (const Link& link : robot.links) {
    const std::optional<Bounds> bounds = bounds_of_body(link.geometries, environment.robot_pose * link.pose);
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

Lift lift_of_robot(const RobotModel& robot, const EnvironmentModel& environment) {
  const Eigen::Vector3d& start = environment.robot_pose.position;
  std::optional<double> top;
  const StaticObject* ground = nullptr;
  for (const StaticObject& object : environment.objects) {
    std::vector<Geometry> solids = object.geometries;
    std::erase_if(solids, [](const Geometry& geometry) { return geometry.mesh != nullptr; });
    const std::optional<Bounds> bounds = bounds_of_body(solids, object.pose);
    if (bounds && (start.head<2>().array() >= bounds->lowest.head<2>().array()).all() &&
        (start.head<2>().array() <= bounds->highest.head<2>().array()).all() && (!top || bounds->highest.z() > *top)) {
      top = bounds->highest.z();
      ground = &object;
    }
  }
  std::optional<double> bottom;
  for (const Link& link : robot.links) {
    if (const auto bounds = bounds_of_body(link.geometries, environment.robot_pose * link.pose)) {
      bottom = bottom ? std::min(*bottom, bounds->lowest.z()) : bounds->lowest.z();
    }
  }
  return top && bottom ? Lift{*top - *bottom, ground} : Lift{};
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
      if (solid.mesh || bounds_of(solid, object.pose).highest.z() > highest) {
        continue;
      }
      for (const Link& link : robot.links) {
        for (const Geometry& geometry : link.geometries) {
          if (const double depth = overlap_depth(geometry, start * link.pose, solid, object.pose);
              depth > deepest.depth) {
            deepest = {depth, &object};
          }
        }
      }
    }
  }
  return deepest;
}

void lift_out_of_solids(const RobotModel& robot, const EnvironmentModel& environment, Lift& lift) {
  constexpr double min_step = 0.001;  // m; each turn lifts by this at least, so the turns end
  Pose start = environment.robot_pose;
  start.position.z() += lift.height;
  std::optional<double> lowest;
  for (const Link& link : robot.links) {
    if (const auto bounds = bounds_of_body(link.geometries, start * link.pose)) {
      lowest = std::min(lowest.value_or(bounds->lowest.z()), bounds->lowest.z());
    }
  }
  if (!lowest) {
    return;
  }
  const double highest = *lowest + highest_step;
  for (Overlap overlap = deepest_overlap(robot, environment, start, highest); overlap.depth > largest_start_depth;
       overlap = deepest_overlap(robot, environment, start, highest)) {
    const double step = std::max(overlap.depth, min_step);
    start.position.z() += step;
    lift = {lift.height + step, overlap.object};
  }
}

}  // namespace

void lift_onto_ground(const RobotModel& robot, EnvironmentModel& environment, std::vector<std::string>& remarks) {
  Lift lift = lift_of_robot(robot, environment);
  if (const Lift onto_mesh = lift_of_links(robot, environment); onto_mesh.height > lift.height) {
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
