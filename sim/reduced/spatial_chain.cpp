#include "sim/reduced/robot_chain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/touch_sensor_frame.hpp"

namespace proleg::sim::reduced {
namespace {

constexpr double rounding_error = 1e-6;

Point3 to_point(const Eigen::Vector3d& vector) {
  return {rounded(vector.x()), rounded(vector.y()), rounded(vector.z())};
}

class SpatialMaker {
 public:
  SpatialMaker(const RobotModel& robot, const EnvironmentModel& environment, double step_s, const std::string& file)
      : robot_(robot), environment_(environment), file_(file) {
    chain_.step_s = step_s;
    chain_.self_collision = environment.self_collision;
  }

  SpatialChain make() {
    if (!environment_.moving_objects.empty()) {
      refuse("object '" + environment_.moving_objects.front().name + "', which moves");
    }
    if (robot_.joints.size() > Spatial::max_joints) {
      refuse("a robot of " + std::to_string(robot_.joints.size()) + " joints");
    }
    for (const StaticObject& object : environment_.objects) {
      for (const Geometry& geometry : object.geometries) {
        add_floor(object, geometry);
      }
    }
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      add_link(i);
    }
    for (const Joint& joint : robot_.joints) {
      // The angle of a joint is that of the link in front of it; in the engine it is that of the link behind it.
      chain_.joints.push_back(
          {{rounded(joint.lower_limit), rounded(joint.upper_limit)}, to_point(-joint.axis.normalized())});
      chain_.joint_signs.push_back(1.0);
    }
    chain_.gravity = to_point(environment_.gravity);
    const Link& head = robot_.links.front();
    chain_.first_link = to_point(environment_.robot_pose * (head.pose * head.mass.center));
    const Eigen::Quaterniond& start = environment_.robot_pose.orientation;
    const double numbers[] = {start.w(), start.x(), start.y(), start.z()};
    std::ranges::transform(numbers, chain_.orientation.begin(), [](double value) { return rounded(value); });
    return std::move(chain_);
  }

 private:
  [[noreturn]] void refuse(const std::string& found) const {
    throw InputError(
        file_, 0, found,
        "what the reduced engine has for a robot whose joints have different axes: boxes as links, and one "
        "level box as floor (or --engine ode)");
  }

  void add_floor(const StaticObject& object, const Geometry& geometry) {
    const std::string name = "object '" + object.name + "'";
    if (floor_ != nullptr) {
      refuse("a second object, '" + object.name + "'");
    }
    if (geometry.shape != Shape::box) {
      refuse(name + " with " + std::string(with_article(geometry.shape)));
    }
    const Pose pose = object.pose * geometry.pose;
    Eigen::Index upright = 0;
    const Eigen::Vector3d up = pose.orientation.conjugate() * Eigen::Vector3d::UnitZ();
    if (up.cwiseAbs().maxCoeff(&upright) < 1.0 - rounding_error) {
      refuse(name + ", which is not level");
    }
    const Eigen::Index a = (upright + 1) % 3;
    const Eigen::Index b = (upright + 2) % 3;
    const double half_height = geometry.extents[upright];
    chain_.terrain.push_back({to_point(pose.position + Eigen::Vector3d(0.0, 0.0, half_height)),
                              to_point(pose.orientation * Eigen::Vector3d::Unit(a)), rounded(geometry.extents[a]),
                              rounded(geometry.extents[b]), rounded(2.0 * half_height)});
    chain_.lowest_ground = pose.position.z() - half_height;
    floor_ = &geometry;
  }

  void add_link(std::size_t i) {
    const Link& link = robot_.links[i];
    const Eigen::Vector3d center = link.pose * link.mass.center;
    const Eigen::Matrix3d turn = link.pose.orientation.toRotationMatrix();
    const Eigen::Matrix3d inertia = turn * link.mass.inertia * turn.transpose();
    for (const double value :
         {inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2)}) {
      chain_.inertias.push_back(rounded(value, 50));
    }
    chain_.masses.push_back(rounded(link.mass.mass));
    const TouchSensorFrame sensors = touch_sensor_frame(robot_, i);
    Spatial::Link form;
    if (i > 0) {
      form.front = to_point(robot_.joints[i - 1].anchor - center);
    }
    if (i < robot_.joints.size()) {
      form.rear = to_point(robot_.joints[i].anchor - center);
    }
    form.sideways = to_point(link.pose.orientation * sensors.sideways);
    chain_.links.push_back(form);
    for (const Geometry& geometry : link.geometries) {
      add_box(i, geometry, sensors);
    }
    chain_.link_orientations.push_back(link.pose.orientation);
    chain_.mass_centers.push_back(link.mass.center);
  }

  void add_box(std::size_t i, const Geometry& geometry, const TouchSensorFrame& sensors) {
    const Link& link = robot_.links[i];
    if (geometry.shape != Shape::box) {
      refuse("link '" + link.name + "' with " + std::string(with_article(geometry.shape)));
    }
    if (geometry.friction_across) {
      refuse("link '" + link.name + "' with another friction across it");
    }
    const Eigen::Vector3d center = geometry.pose.position - link.mass.center;
    Spatial::Shape box;
    box.link = i;
    box.center = to_point(link.pose.orientation * center);
    for (Eigen::Index side = 0; side < 3; ++side) {
      const Eigen::Vector3d middle = geometry.pose.orientation * Eigen::Vector3d::Unit(side) * geometry.extents[side];
      box.sides[side] = to_point(link.pose.orientation * middle);
    }
    for (unsigned number = 0; number < Spatial::corners_of_shape; ++number) {
      const Eigen::Vector3d signs((number & 1U) != 0 ? 1.0 : -1.0, (number & 2U) != 0 ? 1.0 : -1.0,
                                  (number & 4U) != 0 ? 1.0 : -1.0);
      const Eigen::Vector3d corner =
          center + geometry.pose.orientation * Eigen::Vector3d(signs.cwiseProduct(geometry.extents));
      box.corners[number].point = to_point(link.pose.orientation * corner);
      if (rounded(corner.dot(sensors.down)) > 0.0) {
        box.corners[number].sensor = rounded(corner.dot(sensors.forward)) < 0.0 ? 1 : 2;
      }
    }
    box.radius = rounded(center.norm() + geometry.extents.norm()) + rounding_error;
    chain_.shapes.push_back(box);
    const std::optional<double> of_floor = floor_ != nullptr ? floor_->friction : std::nullopt;
    chain_.friction.push_back(rounded(friction_of(geometry.friction, of_floor, environment_.unspecified_friction)));
  }

  const RobotModel& robot_;
  const EnvironmentModel& environment_;
  const std::string& file_;
  SpatialChain chain_;
  const Geometry* floor_ = nullptr;
};

}  // namespace

bool needs_space(const RobotModel& robot, const EnvironmentModel& environment) {
  return std::ranges::any_of(robot.joints, [&](const Joint& joint) {
    const Eigen::Vector3d across = joint.axis.cross(robot.joints.front().axis);
    const Eigen::Vector3d axis = environment.robot_pose.orientation * joint.axis;
    return across.norm() > rounding_error || std::abs(axis.z()) > rounding_error;
  });
}

SpatialChain make_spatial_chain(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                const std::string& file) {
  return SpatialMaker(robot, environment, step_s, file).make();
}

}  // namespace proleg::sim::reduced
