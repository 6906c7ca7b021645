#include "sim/reduced/robot_chain.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/touch_sensor_frame.hpp"

namespace proleg::sim::reduced {
namespace {

constexpr double tolerance = 1e-6;  // m, and rad

Point rounded_point(const Point& point) { return {rounded(point.x), rounded(point.z)}; }

bool is_horizontal(const Eigen::Vector3d& axis) { return std::abs(axis.z()) < tolerance; }
bool are_parallel(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.cross(b).norm() < tolerance; }

class PlanarMaker {
 public:
  PlanarMaker(const RobotModel& robot, const EnvironmentModel& environment, double step_s, const std::string& file)
      : robot_(robot), environment_(environment), file_(file) {
    chain_.step_s = step_s;
    chain_.self_collision = environment.self_collision;
  }

  PlanarChain make() {
    if (!environment_.moving_objects.empty()) {
      refuse("object '" + environment_.moving_objects.front().name + "', which moves");
    }
    set_plane();
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      add_link(i);
    }
    for (const Joint& joint : robot_.joints) {
      add_joint(joint);
    }
    for (const StaticObject& object : environment_.objects) {
      for (const Geometry& geometry : object.geometries) {
        add_solid(object, geometry);
      }
    }
    set_friction();
    const Eigen::Vector3d& gravity = environment_.gravity;
    if (std::abs(gravity.dot(chain_.plane.across)) > tolerance) {
      refuse("gravity across the plane in which the robot moves");
    }
    chain_.gravity = rounded_point(chain_.plane.project(gravity));
    return std::move(chain_);
  }

 private:
  [[noreturn]] void refuse(const std::string& found) const {
    throw InputError(file_, 0, found,
                     "what the reduced engine has: chains of boxes with parallel, horizontal axes on "
                     "boxes (or --engine ode)");
  }

  [[nodiscard]] Pose start_of(const Link& link) const { return environment_.robot_pose * link.pose; }

  void set_plane() {
    MotionPlane& plane = chain_.plane;
    Eigen::Vector3d axis = environment_.robot_pose.orientation * Eigen::Vector3d::UnitX();
    if (!robot_.joints.empty()) {
      axis = environment_.robot_pose.orientation * robot_.joints.front().axis;
    }
    if (!is_horizontal(axis)) {
      refuse(robot_.joints.empty() ? "a robot without joints that stands on its side"
                                   : "joint '" + robot_.joints.front().name + "', whose axis is not horizontal");
    }
    // The angle of a joint is that of the link in front of it about the axis. So that of the link behind turns about
    // the opposite of the axis, which turns x towards z if x is axis x up.
    plane.across =
        Eigen::Vector3d(axis.x(), axis.y(), 0.0).normalized().unaryExpr([](double value) { return rounded(value); });
    plane.x = Eigen::Vector3d(plane.across.y(), -plane.across.x(), 0.0);
    const Link& head = robot_.links.front();
    plane.offset = rounded((start_of(head) * head.mass.center).dot(plane.across));
  }

  void add_link(std::size_t i) {
    const Link& link = robot_.links[i];
    const Pose start = start_of(link);
    const Eigen::Vector3d center = start * link.mass.center;
    require_in_plane(center, "the centre of mass of link '" + link.name + "'");
    const Eigen::Vector3d axis = start.orientation.conjugate() * chain_.plane.across;
    const Eigen::Vector3d about = link.mass.inertia * axis;
    const double inertia = axis.dot(about);
    if ((about - inertia * axis).norm() > 1e-3 * inertia) {
      refuse("link '" + link.name + "', whose mass is not the same on both sides of the plane in which it moves");
    }
    chain_.masses.push_back(rounded(link.mass.mass));
    chain_.inertias.push_back(rounded(inertia, 50));
    Planar::Link form;
    if (i > 0) {
      form.front = from(center, environment_.robot_pose * robot_.joints[i - 1].anchor);
    }
    if (i < robot_.joints.size()) {
      form.rear = from(center, environment_.robot_pose * robot_.joints[i].anchor);
    }
    const TouchSensorFrame sensors = touch_sensor_frame(robot_, i);
    form.forward = rounded_point(chain_.plane.project(start.orientation * sensors.forward));
    form.down = rounded_point(chain_.plane.project(start.orientation * sensors.down));
    chain_.links.push_back(form);
    for (const Geometry& geometry : link.geometries) {
      add_shape(i, geometry, start, center);
    }
    if (i == 0) {
      chain_.first_link = rounded_point(chain_.plane.project(center));
    }
    chain_.link_orientations.push_back(start.orientation);
    chain_.mass_centers.push_back(link.mass.center);
  }

  [[nodiscard]] Point from(const Eigen::Vector3d& center, const Eigen::Vector3d& point) const {
    return rounded_point(chain_.plane.project(point - center));
  }

  void require_in_plane(const Eigen::Vector3d& point, const std::string& name) const {
    if (std::abs(point.dot(chain_.plane.across) - chain_.plane.offset) > tolerance) {
      refuse(name + ", which is not in the plane in which the robot moves");
    }
  }

  void add_shape(std::size_t link, const Geometry& geometry, const Pose& start, const Eigen::Vector3d& center) {
    const std::string name = "link '" + robot_.links[link].name + "'";
    const Pose pose = start * geometry.pose;
    require_in_plane(pose.position, "a shape of " + name);
    if (geometry.friction_across) {
      refuse(name + " with another friction across it");
    }
    const std::optional<Rectangle> outline = section(geometry, {pose.position - center, pose.orientation});
    if (!outline) {
      refuse(geometry.shape == Shape::box ? name + " with a box that is oblique to the plane in which the robot moves"
                                          : name + " with " + std::string(with_article(geometry.shape)));
    }
    Planar::Shape form{link, *outline, 0.0};
    form.radius = rounded(std::hypot(outline->center.x, outline->center.z) +
                          std::hypot(outline->half_length, outline->half_height)) +
                  tolerance;
    chain_.shapes.push_back(form);
    half_width_ = std::max(half_width_, half_extent(geometry, pose, chain_.plane.across));
    shape_geometries_.push_back(&geometry);
  }

  /// m: from the middle of a geometry to its end in a direction.
  static double half_extent(const Geometry& geometry, const Pose& pose, const Eigen::Vector3d& direction) {
    const Eigen::Vector3d own = pose.orientation.conjugate() * direction;
    switch (geometry.shape) {
      case Shape::box:
        return own.cwiseAbs().dot(geometry.extents);
      case Shape::sphere:
        return geometry.extents.x();
      case Shape::cylinder:
        return geometry.extents.x() * std::hypot(own.x(), own.z()) + geometry.extents.y() * std::abs(own.y());
      case Shape::hull:
      case Shape::surface:
      case Shape::height_field: {
        double farthest = 0.0;
        for (const Eigen::Vector3d& vertex : geometry.mesh->vertices) {
          farthest = std::max(farthest, std::abs(own.dot(vertex)));
        }
        return farthest;
      }
    }
    return 0.0;
  }

  /// The section of a box with two sides parallel to the plane; nothing for another shape. pose: of the geometry.
  [[nodiscard]] std::optional<Rectangle> section(const Geometry& geometry, const Pose& pose) const {
    if (geometry.shape != Shape::box) {
      return std::nullopt;
    }
    for (Eigen::Index side = 0; side < 3; ++side) {
      const Eigen::Vector3d normal = pose.orientation * Eigen::Vector3d::Unit(side);
      if (are_parallel(normal, chain_.plane.across)) {
        const Eigen::Index a = (side + 1) % 3;
        const Eigen::Index b = (side + 2) % 3;
        return rectangle(chain_.plane.project(pose.position),
                         chain_.plane.project(pose.orientation * Eigen::Vector3d::Unit(a)), geometry.extents[a],
                         geometry.extents[b]);
      }
    }
    return std::nullopt;
  }

  /// along: unit vector.
  static Rectangle rectangle(const Point& center, const Point& along, double half_length, double half_height) {
    return {rounded_point(center), rounded_point(along), rounded(half_length), rounded(half_height)};
  }

  void add_joint(const Joint& joint) {
    const Eigen::Vector3d axis = environment_.robot_pose.orientation * joint.axis.normalized();
    if (!are_parallel(axis, chain_.plane.across)) {
      refuse("joint '" + joint.name + "', whose axis is not parallel to that of joint '" + robot_.joints.front().name +
             "'");
    }
    const double sign = axis.dot(chain_.plane.across) > 0.0 ? 1.0 : -1.0;
    chain_.joint_signs.push_back(sign);
    const double lower = rounded(joint.lower_limit);
    const double upper = rounded(joint.upper_limit);
    chain_.joints.push_back(sign > 0.0 ? JointLimits{lower, upper} : JointLimits{-upper, -lower});
  }

  void add_solid(const StaticObject& object, const Geometry& geometry) {
    const Pose pose = object.pose * geometry.pose;
    const double distance = std::abs(pose.position.dot(chain_.plane.across) - chain_.plane.offset);
    const double reach = half_extent(geometry, pose, chain_.plane.across);
    const double lowest = pose.position.z() - half_extent(geometry, pose, Eigen::Vector3d::UnitZ());
    chain_.lowest_ground = std::min(chain_.lowest_ground.value_or(lowest), lowest);
    if (distance >= reach + half_width_) {
      return;  // beside the robot's way
    }
    std::optional<Rectangle> outline = section(geometry, pose);
    if (outline && distance + half_width_ > reach) {
      refuse("object '" + object.name + "', which is in the way of a part of the robot's width only");
    }
    if (!outline) {
      outline = section_of_turned_floor(geometry, pose);
    }
    if (!outline) {
      refuse("object '" + object.name + "' with " +
             (geometry.shape == Shape::box ? "a box that is oblique to the plane in which the robot moves"
                                           : std::string(with_article(geometry.shape))));
    }
    chain_.terrain.push_back(*outline);
    solid_geometries_.push_back(&geometry);
  }

  /// The section of an upright box that is turned about the vertical, and under the whole robot: what is under the
  /// whole width of the robot. So its ends are upright in the plane.
  [[nodiscard]] std::optional<Rectangle> section_of_turned_floor(const Geometry& geometry, const Pose& pose) const {
    if (geometry.shape != Shape::box) {
      return std::nullopt;
    }
    double from = -std::numeric_limits<double>::infinity();
    double to = -from;
    std::optional<double> half_height;
    for (Eigen::Index side = 0; side < 3; ++side) {
      const Eigen::Vector3d normal = pose.orientation * Eigen::Vector3d::Unit(side);
      if (are_parallel(normal, Eigen::Vector3d::UnitZ())) {
        half_height = geometry.extents[side];
        continue;
      }
      if (!is_horizontal(normal)) {
        return std::nullopt;
      }
      const double slope = normal.dot(chain_.plane.x);
      const double skew = normal.dot(chain_.plane.across);
      if (std::abs(slope) < tolerance) {
        continue;
      }
      const double middle = normal.dot(pose.position) - skew * chain_.plane.offset;
      const double half = geometry.extents[side] - std::abs(skew) * half_width_;
      from = std::max(from, (slope > 0.0 ? middle - half : middle + half) / slope);
      to = std::min(to, (slope > 0.0 ? middle + half : middle - half) / slope);
    }
    if (!half_height || !(from < to)) {
      return std::nullopt;
    }
    for (const Link& link : robot_.links) {
      const double x = (start_of(link) * link.mass.center).dot(chain_.plane.x);
      if (x < from || x > to) {
        return std::nullopt;
      }
    }
    return rectangle({(from + to) / 2.0, pose.position.z()}, {1.0, 0.0}, (to - from) / 2.0, *half_height);
  }

  [[nodiscard]] double friction(const Geometry& a, const Geometry& b) const {
    return rounded(friction_of(a.friction, b.friction, environment_.unspecified_friction));
  }

  void set_friction() {
    for (const Geometry* shape : shape_geometries_) {
      for (const Geometry* solid : solid_geometries_) {
        chain_.friction.push_back(friction(*shape, *solid));
      }
    }
    for (const Geometry* shape : shape_geometries_) {
      for (const Geometry* other : shape_geometries_) {
        chain_.friction.push_back(friction(*shape, *other));
      }
    }
  }

  const RobotModel& robot_;
  const EnvironmentModel& environment_;
  const std::string& file_;
  PlanarChain chain_;
  double half_width_ = 0.0;  ///< m, of the robot
  std::vector<const Geometry*> shape_geometries_;
  std::vector<const Geometry*> solid_geometries_;
};

}  // namespace

PlanarChain make_planar_chain(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                              const std::string& file) {
  return PlanarMaker(robot, environment, step_s, file).make();
}

}  // namespace proleg::sim::reduced
