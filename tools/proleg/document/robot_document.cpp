#include "tools/proleg/document/robot_document.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <utility>

#include "shared/computer/deflate/deflate.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/document/telemetry_row.hpp"
#include "tools/proleg/document/useful_range.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

/// The meshes of a document. Shapes name a mesh, which they may share, by its number.
class Meshes {
 public:
  /// The shape of a mesh. As for other shapes, its origin is the middle of the box around the mesh, and its size half
  /// of that box. pose: pose of the mesh.
  json shape(const std::shared_ptr<const sim::TriangleMesh>& mesh, const sim::Pose& pose) {
    const std::size_t number = add(mesh);
    const sim::Bounds bounds = sim::bounds_of(*mesh, {});
    const Eigen::Vector3d middle = (bounds.lowest + bounds.highest) / 2.0;
    return {{"kind", "mesh"},
            {"pose", pose_json(pose * sim::Pose{middle, Eigen::Quaterniond::Identity()})},
            {"size", vector_json((bounds.highest - bounds.lowest) / 2.0)},
            {"mesh", number}};
  }

  /// Returns its number.
  std::size_t add(const std::shared_ptr<const sim::TriangleMesh>& mesh) {
    const auto [known, is_new] = numbers_.try_emplace(mesh.get(), meshes_.size());
    if (is_new) {
      meshes_.push_back(mesh);
    }
    return known->second;
  }

  [[nodiscard]] const RobotMeshes& all() const { return meshes_; }

 private:
  RobotMeshes meshes_;
  std::map<const sim::TriangleMesh*, std::size_t> numbers_;
};

/// Numbers as base64 of their bytes, little-endian: as text in decimals they take twice the place, and as values of
/// JSON ten times.
template <typename Number>
std::string in_base64(const std::vector<Number>& numbers) {
  static_assert(std::endian::native == std::endian::little);
  const auto bytes = std::as_bytes(std::span(numbers));
  return base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// Vertices are about the middle of the box around the mesh.
json mesh_json(const sim::TriangleMesh& mesh) {
  const sim::Bounds bounds = sim::bounds_of(mesh, {});
  const Eigen::Vector3d middle = (bounds.lowest + bounds.highest) / 2.0;
  std::vector<float> vertices;
  vertices.reserve(3 * mesh.vertices.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    for (const double coordinate : Eigen::Vector3d(vertex - middle)) {
      vertices.push_back(static_cast<float>(coordinate));
    }
  }
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  std::vector<std::uint8_t> colours;
  colours.reserve(3 * mesh.colours.size());
  for (const Eigen::Vector3f& colour : mesh.colours) {
    for (const float part : colour) {
      colours.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(part * 255.0F), 0L, 255L)));
    }
  }
  return {{"vertices", in_base64(vertices)}, {"triangles", in_base64(corners)}, {"colours", in_base64(colours)}};
}

json shapes_json(std::span<const sim::Geometry> geometries, std::span<const sim::Look> looks, Meshes& meshes) {
  json shapes = json::array();
  for (const sim::Geometry& geometry : geometries) {
    if (!geometry.is_shown) {
      continue;
    }
    const Eigen::Vector3d& extents = geometry.extents;
    json shape{{"pose", pose_json(geometry.pose)}};
    switch (geometry.shape) {
      case sim::Shape::box:
        shape["kind"] = "box";
        shape["size"] = vector_json(extents);
        break;
      case sim::Shape::sphere:
        shape["kind"] = "sphere";
        shape["size"] = {extents.x(), 0.0, 0.0};
        break;
      case sim::Shape::cylinder:
        shape["kind"] = "cylinder";
        shape["size"] = {extents.x(), extents.y(), 0.0};
        break;
      case sim::Shape::hull:
      case sim::Shape::surface:
      case sim::Shape::height_field:
        shape = meshes.shape(geometry.mesh, geometry.pose);
        break;
    }
    shapes.push_back(std::move(shape));
  }
  for (const sim::Look& look : looks) {
    shapes.push_back(meshes.shape(look.mesh, look.pose));
  }
  return shapes;
}

/// The shapes of a link, a static object or one that moves.
template <typename Body>
json body_json(const Body& body, Meshes& meshes) {
  return {{"name", body.name},
          {"pose", pose_json(body.pose)},
          {"shapes", shapes_json(body.geometries, body.looks, meshes)}};
}

template <typename Body>
json bodies_json(const std::vector<Body>& bodies, Meshes& meshes) {
  json result = json::array();
  for (const Body& body : bodies) {
    result.push_back(body_json(body, meshes));
  }
  return result;
}

json rulers_json(const std::vector<sim::Ruler>& rulers) {
  json result = json::array();
  for (const sim::Ruler& ruler : rulers) {
    result.push_back({{"from", vector_json(ruler.from)},
                      {"to", vector_json(ruler.to)},
                      {"division", ruler.division},
                      {"width", ruler.width}});
  }
  return result;
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

json joints_json(const sim::Scenario& scenario) {
  json joints = json::array();
  for (std::size_t j = 0; j < scenario.robot.joints.size(); ++j) {
    const sim::Joint& joint = scenario.robot.joints[j];
    json object{{"name", joint.name},
                {"lower", degrees(joint.lower_limit)},
                {"upper", degrees(joint.upper_limit)},
                {"anchor", vector_json(joint.anchor)},
                {"axis", vector_json(joint.axis)}};
    if (j < scenario.modules.size()) {
      object["node"] = scenario.modules[j].node;
    }
    joints.push_back(std::move(object));
  }
  return joints;
}

json joints_of(JointMask group) {
  json joints = json::array();
  for (const unsigned joint : group) {
    joints.push_back(joint);
  }
  return joints;
}

json parameter_json(const sim::Scenario& scenario, const ParameterTable& table, unsigned slot, unsigned index) {
  const Slot& used = scenario.kernel.slots[slot];
  const Parameter& parameter = used.algorithm->declaration().parameters[index];
  json object = parameter_declaration_json(parameter);
  object["slot"] = slot + 1;
  object["internal"] = false;
  object["joints"] = joints_of(used.group);
  json& file = object["file"] = json::array();
  json& wanted = object["wanted"] = json::array();
  json& confirmed = object["confirmed"] = json::array();
  json& tick = object["tick"] = json::array();
  for (const unsigned joint : used.group) {
    const ParameterTable::Values& values =
        table.at({static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(joint), static_cast<std::uint8_t>(index)});
    file.push_back(values.file);
    wanted.push_back(values.wanted);
    confirmed.push_back(values.confirmed);
    tick.push_back(values.tick);
  }
  return object;
}

/// An internal value has no wanted value: it can be overwritten once, as a distortion.
json internal_value_json(const sim::Scenario& scenario, unsigned slot, const InternalValue& value) {
  return {{"slot", slot + 1},
          {"name", value.name},
          {"unit", sim::shown_unit(value.unit)},
          {"scale", value_of_step(value.unit)},
          {"wraps", wraps(value.unit)},
          {"help", value.help},
          {"internal", true},
          {"joints", joints_of(scenario.kernel.slots[slot].group)}};
}

}  // namespace

ParameterTable::ParameterTable(const sim::Scenario& file, const sim::Scenario& start)
    : joints_(file.kernel.joint_count), values_(max_slots * max_parameters * joints_) {
  for (const unsigned slot : sim::used_slots(file)) {
    const Slot& used = file.kernel.slots[slot];
    const std::size_t parameters = used.algorithm->declaration().parameters.size();
    for (unsigned number = 0; number < parameters; ++number) {
      for (unsigned joint = 0; joint < joints_; ++joint) {
        if (!used.group.contains(joint)) {
          continue;
        }
        const ParameterPlace place{static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(joint),
                                   static_cast<std::uint8_t>(number)};
        places_.push_back(place);
        const std::int32_t value = sim::start_value(start, slot, joint, number);
        values_[position(place)] = {0, value, value, 0};
      }
    }
  }
  set_file(file);
}

void ParameterTable::confirm(const ParameterPlace& place, std::int32_t value, std::uint32_t tick) {
  Values& values = values_[position(place)];
  values.confirmed = value;
  values.tick = tick;
}

void ParameterTable::begin_run() {
  for (Values& values : values_) {
    values.confirmed = values.wanted;
    values.tick = 0;
  }
}

void ParameterTable::want_file_values() {
  for (Values& values : values_) {
    values.wanted = values.file;
  }
}

void ParameterTable::set_file(const sim::Scenario& file) {
  for (const ParameterPlace& place : places_) {
    values_[position(place)].file = sim::start_value(file, place.slot, place.joint, place.number);
  }
}

std::size_t ParameterTable::position(const ParameterPlace& place) const {
  return (std::size_t{place.slot} * max_parameters + place.number) * joints_ + place.joint;
}

json vector_json(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

json pose_json(const sim::Pose& pose) {
  const Eigen::Quaterniond& turn = pose.orientation;
  return {pose.position.x(), pose.position.y(), pose.position.z(), turn.w(), turn.x(), turn.y(), turn.z()};
}

RobotMeshes robot_meshes(const sim::Scenario& scenario) {
  Meshes meshes;
  const auto add = [&meshes](const auto& bodies) {
    for (const auto& body : bodies) {
      for (const sim::Geometry& geometry : body.geometries) {
        if (geometry.is_shown && geometry.mesh) {
          meshes.add(geometry.mesh);
        }
      }
      for (const sim::Look& look : body.looks) {
        meshes.add(look.mesh);
      }
    }
  };
  add(scenario.robot.links);
  add(scenario.environment.objects);
  add(scenario.environment.moving_objects);
  return meshes.all();
}

bool are_same(const RobotMeshes& meshes, const RobotMeshes& others) {
  return std::ranges::equal(meshes, others, [](const auto& one, const auto& other) {
    return one == other ||
           (one->triangles == other->triangles && one->vertices == other->vertices && one->colours == other->colours);
  });
}

json meshes_json(const RobotMeshes& meshes) {
  json documents = json::array();
  for (const auto& mesh : meshes) {
    documents.push_back(mesh_json(*mesh));
  }
  return documents;
}

json robot_document(const sim::Scenario& scenario, std::string_view kind, MeshesInDocument with_meshes) {
  Meshes meshes;
  json links = bodies_json(scenario.robot.links, meshes);
  json terrain = bodies_json(scenario.environment.objects, meshes);
  json objects = bodies_json(scenario.environment.moving_objects, meshes);
  json slots = json::array();
  for (const unsigned slot : sim::used_slots(scenario)) {
    slots.push_back({{"number", slot + 1},
                     {"algorithm", scenario.kernel.slots[slot].algorithm->declaration().name},
                     {"help", scenario.kernel.slots[slot].algorithm->declaration().help},
                     {"joints", joints_of(scenario.kernel.slots[slot].group)}});
  }
  return {{"name", scenario.robot.name},
          {"file", std::filesystem::path(scenario.path).filename().string()},
          {"kind", kind},
          {"joints", joints_json(scenario)},
          {"links", std::move(links)},
          {"terrain", std::move(terrain)},
          {"objects", std::move(objects)},
          {"rulers", rulers_json(scenario.environment.rulers)},
          {"meshes", with_meshes == MeshesInDocument::yes ? meshes_json(meshes.all()) : json::array()},
          {"slots", std::move(slots)}};
}

json parameter_declaration_json(const Parameter& parameter) {
  const UsefulRange useful = useful_range(parameter);
  return {{"name", parameter.name},
          {"unit", sim::shown_unit(parameter.unit)},
          {"scale", value_of_step(parameter.unit)},
          {"wraps", wraps(parameter.unit)},
          {"minimum", parameter.minimum},
          {"maximum", parameter.maximum},
          {"default", parameter.default_value},
          {"useful", {useful.lower, useful.upper}},
          {"help", one_line(std::string_view(parameter.help))}};
}

json parameters_document(const sim::Scenario& scenario, const ParameterTable& table) {
  json document = json::array();
  for (const unsigned slot : sim::used_slots(scenario)) {
    const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
    for (unsigned index = 0; index < declaration.parameters.size(); ++index) {
      document.push_back(parameter_json(scenario, table, slot, index));
    }
    for (const InternalValue& value : declaration.internal_values) {
      document.push_back(internal_value_json(scenario, slot, value));
    }
  }
  return document;
}

}  // namespace proleg::tools
