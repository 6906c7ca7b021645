#include "sim/scenario/geometry_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

using std::numbers::pi;

/// For viewers only.
constexpr std::array<std::string_view, 5> visual_tags{"diffuseColor", "ambientColor", "transparency", "render",
                                                      "visible"};

double volume(const Geometry& geometry) {
  const Eigen::Vector3d& size = geometry.extents;
  switch (geometry.shape) {
    case Shape::box:
      return 8.0 * size.prod();
    case Shape::sphere:
      return 4.0 / 3.0 * pi * size.x() * size.x() * size.x();
    case Shape::cylinder:
      return pi * size.x() * size.x() * 2.0 * size.y();
  }
  return 0.0;
}

/// About the centre, along the axes of the geometry, mass 1.
Eigen::Matrix3d shape_inertia(const Geometry& geometry) {
  const Eigen::Vector3d& size = geometry.extents;
  switch (geometry.shape) {
    case Shape::box:
      return box_inertia(size);
    case Shape::sphere:
      return 0.4 * size.x() * size.x() * Eigen::Matrix3d::Identity();
    case Shape::cylinder: {
      const double radius_squared = size.x() * size.x();
      const double across = radius_squared / 4.0 + size.y() * size.y() / 3.0;
      return Eigen::Vector3d(across, radius_squared / 2.0, across).asDiagonal();
    }
  }
  return Eigen::Matrix3d::Zero();
}

}  // namespace

Geometry read_geometry(const XmlElement& element) {
  Geometry geometry;
  const std::string type = lower_case(element.required_attribute("type"));
  const auto allow_tags = [&element](std::initializer_list<std::string_view> size_tags) {
    constexpr std::array<std::string_view, 3> attributes{"type", "name", "render"};
    constexpr std::array<std::string_view, 1> friction{"friction"};
    const std::span<const std::string_view> sizes(size_tags.begin(), size_tags.size());
    element.allow(attributes, joined({sizes, pose_tags, friction, visual_tags}));
  };
  if (type == "box") {
    allow_tags({"extents"});
    geometry.shape = Shape::box;
    geometry.extents = read_vector(element.required_child("extents"), lengths);
  } else if (type == "sphere") {
    allow_tags({"radius"});
    geometry.shape = Shape::sphere;
    geometry.extents.x() = read_number(element.required_child("radius"), lengths);
  } else if (type == "cylinder") {
    allow_tags({"radius", "height"});
    geometry.shape = Shape::cylinder;
    geometry.extents.x() = read_number(element.required_child("radius"), lengths);
    geometry.extents.y() = read_number(element.required_child("height"), lengths) / 2.0;
  } else {
    element.refuse("type " + in_quotes(type) + " in " + element.label(), "'box', 'sphere' or 'cylinder'");
  }
  geometry.pose = read_pose(element);
  if (const auto friction = element.child("friction")) {
    geometry.friction = read_number(*friction, frictions);
  }
  return geometry;
}

Eigen::Matrix3d box_inertia(const Eigen::Vector3d& half_sides) {
  const Eigen::Vector3d squares = half_sides.cwiseProduct(half_sides);
  return (Eigen::Vector3d::Constant(squares.sum()) - squares).asDiagonal().toDenseMatrix() / 3.0;
}

SolidProperties solid_properties(const std::vector<Geometry>& geometries) {
  SolidProperties whole;
  for (const Geometry& geometry : geometries) {
    whole.volume += volume(geometry);
    whole.center += volume(geometry) * geometry.pose.position;
  }
  if (geometries.empty()) {
    return whole;
  }
  whole.center /= whole.volume;
  for (const Geometry& geometry : geometries) {
    const Eigen::Matrix3d rotation = geometry.pose.orientation.toRotationMatrix();
    const Eigen::Vector3d arm = geometry.pose.position - whole.center;
    const Eigen::Matrix3d parallel_axes = arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
    whole.inertia += volume(geometry) * (rotation * shape_inertia(geometry) * rotation.transpose() + parallel_axes);
  }
  return whole;
}

}  // namespace proleg::sim
