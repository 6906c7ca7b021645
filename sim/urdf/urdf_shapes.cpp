#include "sim/urdf/urdf_shapes.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr std::string_view known_kinds = "one <box>, <sphere>, <cylinder>, <capsule> or <mesh>";

Eigen::Vector3d vector_of(const std::vector<double>& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

Eigen::Vector3d scale_of(const XmlElement& mesh) {
  if (!mesh.attribute("scale")) {
    return Eigen::Vector3d::Ones();
  }
  if (words(urdf_value(mesh, "scale")).size() == 1) {
    return Eigen::Vector3d::Constant(urdf_number(mesh, "scale", any_number));
  }
  return vector_of(urdf_numbers(mesh, "scale", 3, any_number));
}

std::vector<UrdfShape> solids_of(const XmlElement& solid, const UrdfShape& place, UrdfRemarks& remarks) {
  UrdfShape shape = place;
  if (solid.is("mesh")) {
    lose_others(solid, {"filename", "scale"}, {}, remarks);
    shape.kind = UrdfShape::Kind::mesh;
    shape.mesh = urdf_value(solid, "filename");
    if (shape.mesh.empty()) {
      solid.refuse("an empty filename in " + solid.label(), "that of a mesh");
    }
    shape.size = scale_of(solid);
    return {shape};
  }
  if (solid.is("box")) {
    lose_others(solid, {"size"}, {}, remarks);
    shape.size = vector_of(urdf_numbers(solid, "size", 3, urdf_sizes));
  } else {
    const bool is_sphere = solid.is("sphere");
    shape.kind = is_sphere ? UrdfShape::Kind::sphere : UrdfShape::Kind::cylinder;
    shape.size.x() = urdf_number(solid, "radius", urdf_sizes);
    if (is_sphere) {
      lose_others(solid, {"radius"}, {}, remarks);
    } else {
      lose_others(solid, {"radius", "length"}, {}, remarks);
      shape.size.y() = urdf_number(solid, "length", urdf_sizes);
    }
  }
  if (shape.size.minCoeff() < lengths.min) {
    remarks.lost.add("a " + solid.label() + " without volume, which nothing touches", solid.line());
    return {};
  }
  std::vector<UrdfShape> result{shape};
  if (solid.is("capsule")) {  // its length is that of the cylinder
    for (const double end : {-0.5, 0.5}) {
      UrdfShape cap = shape;
      cap.kind = UrdfShape::Kind::sphere;
      cap.size = {shape.size.x(), 1.0, 1.0};
      cap.pose.position += shape.pose.orientation * Eigen::Vector3d(0.0, 0.0, end * shape.size.y());
      result.push_back(cap);
    }
  }
  return result;
}

std::optional<Eigen::Vector3d> look_colour(const XmlElement& visual, const UrdfElements& elements,
                                           UrdfRemarks& remarks) {
  std::vector<XmlElement> materials;
  for (const XmlElement& child : visual.children()) {
    if (child.is("material")) {
      materials.push_back(child);
    }
  }
  if (materials.empty()) {
    return std::nullopt;
  }
  if (materials.size() > 1) {
    remarks.lost.add("a second <material> of a <visual>", materials[1].line());
  }
  const XmlElement& material = materials.front();
  lose_others(material, {"name"}, {"color", "texture"}, remarks);
  const std::vector<XmlElement> children = material.children();
  const auto has = [&](std::string_view tag) {
    return std::ranges::any_of(children, [&](const XmlElement& child) { return child.is(tag); });
  };
  if (has("texture")) {
    remarks.lost.add("<texture> of a <visual>", material.line());
    return std::nullopt;
  }
  if (has("color")) {
    return urdf_colour(material, remarks);
  }
  const auto known = elements.materials.find(material.attribute("name").value_or(""));
  return known == elements.materials.end() ? std::nullopt : std::optional(known->second);
}

}  // namespace

std::vector<UrdfShape> urdf_shapes(const XmlElement& element, UrdfRemarks& remarks) {
  lose_others(element, {"name"}, {"origin", "geometry", element.is("visual") ? "material" : "geometry"}, remarks);
  const auto geometry = element.child("geometry");
  const std::vector<XmlElement> solids = geometry ? geometry->children() : std::vector<XmlElement>{};
  if (solids.empty()) {
    remarks.lost.add("a " + element.label() + " without a geometry", element.line());
    return {};
  }
  if (solids.size() > 1) {
    geometry->refuse(std::to_string(solids.size()) + " shapes in " + geometry->label() + ", " + solids[0].label() +
                         " and " + solids[1].label(),
                     "one; give each a " + element.label() + " of its own");
  }
  constexpr std::array<std::string_view, 5> kinds{"box", "sphere", "cylinder", "capsule", "mesh"};
  if (std::ranges::none_of(kinds, [&](std::string_view kind) { return solids[0].is(kind); })) {
    geometry->refuse(solids[0].label() + " in " + geometry->label(), std::string(known_kinds));
  }
  UrdfShape place;
  place.pose = urdf_origin(element, remarks);
  place.line = element.line();
  return solids_of(solids[0], place, remarks);
}

std::vector<UrdfShape> urdf_looks(const XmlElement& visual, const UrdfElements& elements, UrdfRemarks& remarks) {
  std::vector<UrdfShape> shapes = urdf_shapes(visual, remarks);
  const std::optional<Eigen::Vector3d> colour = look_colour(visual, elements, remarks);
  for (UrdfShape& shape : shapes) {
    shape.colour = colour;
  }
  return shapes;
}

}  // namespace proleg::sim
