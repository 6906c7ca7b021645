#include "sim/scenario/geometry_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "shared/computer/text/text.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/mesh/mesh_geometry.hpp"
#include "sim/scenario/mesh_reader.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

using std::numbers::pi;

/// Tags that only viewers use.
constexpr std::array<std::string_view, 5> visual_tags{"diffuseColor", "ambientColor", "transparency", "render",
                                                      "visible"};

/// Range of red, green and blue in a colour.
constexpr Range colour_parts{0.0, 1.0, ""};

/// The tags that give the size of a box, sphere or cylinder; none for another type.
std::span<const std::string_view> size_tags(std::string_view type) {
  static constexpr std::array<std::string_view, 1> of_box{"extents"};
  static constexpr std::array<std::string_view, 2> of_cylinder{"radius", "height"};
  if (type == "box") {
    return of_box;
  }
  const std::span<const std::string_view> round = of_cylinder;
  return round.first(type == "cylinder" ? 2 : type == "sphere" ? 1 : 0);
}

/// Shape and size of a box (<extents>: half sides), a sphere (<radius>) or a cylinder (<radius>, <height>; axis along
/// y).
Geometry read_solid(const XmlElement& element, std::string_view type) {
  Geometry result;
  if (type == "box") {
    result.shape = Shape::box;
    result.extents = read_vector(element.required_child("extents"), lengths);
    return result;
  }
  result.shape = type == "sphere" ? Shape::sphere : Shape::cylinder;
  result.extents.x() = read_number(element.required_child("radius"), lengths);
  if (result.shape == Shape::cylinder) {
    result.extents.y() = read_number(element.required_child("height"), lengths) / 2.0;
  }
  return result;
}

double volume(const Geometry& geometry) {
  const Eigen::Vector3d& size = geometry.extents;
  switch (geometry.shape) {
    case Shape::box:
      return 8.0 * size.prod();
    case Shape::sphere:
      return 4.0 / 3.0 * pi * size.x() * size.x() * size.x();
    case Shape::cylinder:
      return pi * size.x() * size.x() * 2.0 * size.y();
    case Shape::hull:
    case Shape::surface:
    case Shape::height_field:
      return solid_of(*geometry.mesh).volume;
  }
  return 0.0;
}

/// Inertia about the centre of a box with these half sides and mass 1.
Eigen::Matrix3d box_inertia(const Eigen::Vector3d& half_sides) {
  const Eigen::Vector3d squares = half_sides.cwiseProduct(half_sides);
  return (Eigen::Vector3d::Constant(squares.sum()) - squares).asDiagonal().toDenseMatrix() / 3.0;
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
    case Shape::hull:
    case Shape::surface:
    case Shape::height_field: {
      const MeshSolid solid = solid_of(*geometry.mesh);
      return solid.inertia / solid.volume;
    }
  }
  return Eigen::Matrix3d::Zero();
}

void set_mesh(Geometry& geometry, Shape shape, std::shared_ptr<const TriangleMesh> mesh) {
  geometry.shape = shape;
  geometry.mesh = std::move(mesh);
  for (const Eigen::Vector3d& vertex : geometry.mesh->vertices) {
    geometry.extents = geometry.extents.cwiseMax(vertex.cwiseAbs());
  }
  geometry.extents = geometry.extents.cwiseMax(lengths.min);
}

/// What is touched. A mesh of a file is also what is shown, with its colours; a <render> replaces it.
void read_trimesh(const XmlElement& element, BodyKind kind, SourceSet& sources, std::vector<std::string>& remarks,
                  ReadGeometry& result) {
  const auto data = element.child("data");
  const auto collision = element.child("collision");
  const auto vertices = element.child("vertices");
  const int count = (data ? 1 : 0) + (collision ? 1 : 0) + (vertices ? 1 : 0);
  if (count == 0) {
    result.solid.reset();
    return;
  }
  if (count > 1) {
    element.refuse("more than one of <data>, <collision> and <vertices> in " + element.label(), "one of them");
  }
  const Shape shape = kind == BodyKind::moving ? Shape::hull : Shape::surface;
  const MeshUse use = kind == BodyKind::moving ? MeshUse::hull : MeshUse::surface;
  const bool is_open = element.attribute("open") && read_switch_attribute(element, "open");
  if (is_open && kind == BodyKind::moving) {
    remark_no_effect_of("open", remarks, element, "a body that moves touches with the convex hull of its mesh");
  }
  if (const auto triangles = element.child("triangles"); triangles && !vertices) {
    triangles->refuse(triangles->label() + " without <vertices>", "both, or a file in <data>");
  }
  if (vertices) {
    set_mesh(*result.solid, shape, read_mesh_of_text(element, use, is_open, remarks));
    return;
  }
  const XmlElement& file = data ? *data : *collision;
  set_mesh(*result.solid, shape, read_mesh_of_file(file, use, is_open, sources, remarks));
  if (shape == Shape::hull) {
    result.look = Look{{}, read_mesh_of_file(file, MeshUse::look, true, sources, remarks)};
  }
}

/// Values for viewers that have no effect here are checked all the same.
void check_visual_values(const XmlElement& element) {
  for (const std::string_view tag : {"diffuseColor", "ambientColor"}) {
    if (const auto colour = element.child(tag)) {
      static_cast<void>(read_vector(*colour, colour_parts));
    }
  }
  if (const auto transparency = element.child("transparency")) {
    static_cast<void>(read_number(*transparency, colour_parts));
  }
  if (const auto visible = element.child("visible")) {
    static_cast<void>(read_switch(*visible));
  }
  if (element.attribute("render")) {
    static_cast<void>(read_switch_attribute(element, "render"));
  }
}

/// <diffuseColor> is the colour of a mesh that has none.
void paint(const XmlElement& element, SourceSet& sources, ReadGeometry& result) {
  const auto colour = element.child("diffuseColor");
  if (!colour || (!result.look && !(result.solid && result.solid->mesh))) {
    return;  // other shapes have the colours of the page
  }
  const Eigen::Vector3f rgb = read_vector(*colour, colour_parts).cast<float>();
  std::shared_ptr<const TriangleMesh>& mesh = result.look ? result.look->mesh : result.solid->mesh;
  if (mesh->colours.empty()) {
    mesh = painted(mesh, rgb, sources);
  }
}

/// <render> is a mesh, or, as in the thesis's files, a switch of the viewer. A file of another kind, such as VRML, is
/// not shown.
bool is_mesh(const XmlElement& render, SourceSet& sources, std::vector<std::string>& remarks) {
  const std::string file = mesh_file_named_by(render, sources);
  if (is_mesh_file_name(file)) {
    return true;
  }
  if (file.find('.') == std::string::npos) {
    static_cast<void>(read_switch(render));
    return false;
  }
  remark_no_effect(remarks, render,
                   "meshes that can be shown are files that end with " + std::string(mesh_file_endings));
  return false;
}

/// The centre of the geometry's volume, in the frame of the body.
Eigen::Vector3d center_of(const Geometry& geometry) {
  return geometry.mesh ? geometry.pose * solid_of(*geometry.mesh).center : geometry.pose.position;
}

/// What <Mass> may use of the solids of a body. The overlap of two solids counts twice.
struct SolidProperties {
  double volume = 0.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   ///< of volume, in the frame of the body
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre, at density 1
};

SolidProperties solid_properties(const std::vector<Geometry>& geometries) {
  SolidProperties whole;
  for (const Geometry& geometry : geometries) {
    whole.volume += volume(geometry);
    whole.center += volume(geometry) * center_of(geometry);
  }
  if (geometries.empty()) {
    return whole;
  }
  whole.center /= whole.volume;
  for (const Geometry& geometry : geometries) {
    const Eigen::Matrix3d rotation = geometry.pose.orientation.toRotationMatrix();
    const Eigen::Vector3d arm = center_of(geometry) - whole.center;
    const Eigen::Matrix3d parallel_axes = arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
    whole.inertia += volume(geometry) * (rotation * shape_inertia(geometry) * rotation.transpose() + parallel_axes);
  }
  return whole;
}

constexpr Range inertias{-1e12, 1e12, "kg m^2"};

/// The mass from <total>, or from <density> and a volume.
double read_total(const XmlElement& element, double volume) {
  const std::optional<XmlElement> total = element.child("total");
  const std::optional<XmlElement> density = element.child("density");
  if (total.has_value() == density.has_value()) {
    element.refuse((total ? "both <total> and <density> in " : "neither <total> nor <density> in ") + element.label(),
                   "one of them");
  }
  if (total) {
    return read_number(*total, masses);
  }
  const double mass = read_number(*density, densities) * volume;
  if (mass < masses.min || mass > masses.max) {
    density->refuse("a density that makes " + number_text(mass) + " kg",
                    "a mass from " + number_text(masses.min) + " to " + number_text(masses.max) + " kg");
  }
  return mass;
}

SolidProperties required_solids(const XmlElement& element, const std::vector<Geometry>& geometries,
                                const std::string& what) {
  if (geometries.empty()) {
    element.refuse(element.label() + " of a body without <Geom>", what);
  }
  return solid_properties(geometries);
}

MassProperties read_custom(const XmlElement& element, const std::vector<Geometry>& geometries) {
  element.allow({"type"}, {"total", "com", "inertia"});
  MassProperties result;
  result.mass = read_number(element.required_child("total"), masses);
  const std::optional<XmlElement> com = element.child("com");
  const std::optional<XmlElement> inertia = element.child("inertia");
  if (com) {
    result.center = read_vector(*com, coordinates);
  } else {
    result.center = required_solids(element, geometries, "<com> in the <Mass>").center;
  }
  if (inertia) {
    const std::vector<double> numbers = read_numbers(*inertia, 9, inertias);
    result.inertia = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  } else {
    const SolidProperties solids = required_solids(element, geometries, "<inertia> in the <Mass>");
    result.inertia = solids.inertia * (result.mass / solids.volume);
  }
  return result;
}

/// The mass of a box, sphere or cylinder, whose size the <Mass> has.
MassProperties read_solid_mass(const XmlElement& element, std::string_view type) {
  constexpr std::array<std::string_view, 1> attributes{"type"};
  constexpr std::array<std::string_view, 3> tags{"total", "density", "com"};
  element.allow(attributes, joined({size_tags(type), tags}));
  const Geometry solid = read_solid(element, type);
  MassProperties result;
  result.mass = read_total(element, volume(solid));
  if (const auto com = element.child("com")) {
    result.center = read_vector(*com, coordinates);
  }
  result.inertia = result.mass * shape_inertia(solid);
  return result;
}

MassProperties read_mimic(const XmlElement& element, const std::vector<Geometry>& geometries) {
  element.allow({"type"}, {"total", "density"});
  const SolidProperties solids = required_solids(element, geometries, "another type, or a <Geom>");
  const double mass = read_total(element, solids.volume);
  return {mass, solids.center, solids.inertia * (mass / solids.volume)};
}

/// False also for a matrix that is nearly singular: rounding would make it singular in the engine.
bool is_positive_definite(const Eigen::Matrix3d& inertia) {
  constexpr double tolerance = 1e-9;
  const double size = inertia.cwiseAbs().maxCoeff();
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() > tolerance * size) {
    return false;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() > tolerance * size;
}

}  // namespace

ReadGeometry read_geometry(const XmlElement& element, BodyKind kind, SourceSet& sources,
                           std::vector<std::string>& remarks) {
  ReadGeometry result;
  Geometry& geometry = result.solid.emplace();
  const std::string type = lower_case(element.required_attribute("type"));
  const auto allow_tags = [&element, &type](std::span<const std::string_view> sizes) {
    constexpr std::array<std::string_view, 4> attributes{"type", "name", "render", "open"};  // a mesh may be open
    const std::size_t count = attributes.size() - (type == "trimesh" ? 0 : 1);
    constexpr std::array<std::string_view, 2> friction{"friction", "frictionAcross"};
    element.allow(std::span(attributes).first(count), joined({sizes, pose_tags, friction, visual_tags}));
    check_visual_values(element);
  };
  if (const auto sizes = size_tags(type); !sizes.empty()) {
    allow_tags(sizes);
    geometry = read_solid(element, type);
  } else if (type == "trimesh") {
    allow_tags(std::array<std::string_view, 4>{"data", "collision", "vertices", "triangles"});
    read_trimesh(element, kind, sources, remarks, result);
  } else if (type == "heightfield") {
    allow_tags(std::array<std::string_view, 5>{"extents", "columns", "rows", "heights", "data"});
    if (kind != BodyKind::fixed) {
      element.refuse("a height field in a body that moves", "one in a body of type 'static' of an environment");
    }
    read_height_field(element, sources, geometry);
  } else {
    element.refuse("type " + in_quotes(type) + " in " + element.label(),
                   "'box', 'sphere', 'cylinder', 'trimesh' or 'heightfield'");
  }
  const Pose pose = read_pose(element);
  if (const auto render = element.child("render"); render && is_mesh(*render, sources, remarks)) {
    result.look = Look{pose, read_mesh_of_file(*render, MeshUse::look, true, sources, remarks)};
  }
  paint(element, sources, result);
  if (result.look) {
    result.look->pose = pose;
  }
  if (!result.solid) {
    if (!result.look) {
      element.refuse("no mesh in " + element.label(), "<data>, <vertices> or <render>");
    }
    for (const std::string_view tag : {"friction", "frictionAcross"}) {
      if (const auto child = element.child(tag)) {
        static_cast<void>(read_number(*child, frictions));
        remark_no_effect(remarks, *child, "a mesh that is only shown touches nothing");
      }
    }
    return result;
  }
  geometry.pose = pose;
  geometry.is_shown = !result.look;
  if (const auto friction = element.child("friction")) {
    geometry.friction = read_number(*friction, frictions);
  }
  if (const auto across = element.child("frictionAcross")) {
    if (kind == BodyKind::fixed) {
      across->refuse(across->label() + " in a static body", "it in a link of a robot, or in a body that moves");
    }
    geometry.friction_across = read_number(*across, frictions);
  }
  return result;
}

MassProperties read_mass(const XmlElement& element, const std::vector<Geometry>& geometries) {
  const std::string type = lower_case(element.required_attribute("type"));
  MassProperties result;
  if (type == "custom") {
    result = read_custom(element, geometries);
  } else if (!size_tags(type).empty()) {
    result = read_solid_mass(element, type);
  } else if (type == "mimicgeom") {
    result = read_mimic(element, geometries);
  } else {
    element.refuse("type " + in_quotes(type) + " in " + element.label(),
                   "'custom', 'box', 'sphere', 'cylinder' or 'mimicgeom'");
  }
  if (!is_positive_definite(result.inertia)) {
    element.refuse("an inertia that is not positive definite in " + element.label(),
                   "a symmetric matrix with eigenvalues above 0, the smallest above 1e-9 of the largest");
  }
  result.inertia = (result.inertia + result.inertia.transpose().eval()) / 2.0;
  return result;
}

}  // namespace proleg::sim
