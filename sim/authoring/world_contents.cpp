#include "sim/authoring/world_contents.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/values.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

/// An element by itself, for the functions of the reader.
XmlDocument parsed(const XmlText& xml, ElementNumber element) {
  return {xml.name(), std::string(xml.bytes(element)), nullptr};
}

/// The numbers in a child of an element; nothing without it.
std::optional<std::vector<double>> numbers_in(const XmlElement& element, std::string_view tag) {
  const std::optional<XmlElement> child = element.child(tag);
  if (!child) {
    return std::nullopt;
  }
  std::vector<double> numbers;
  const std::string text = child->text({"unit"});
  for (const std::string_view word : words(text)) {
    numbers.push_back(parse_number(word).value_or(0.0));
  }
  return numbers;
}

WorldShape read_shape(const XmlText& xml, ElementNumber geom) {
  const XmlDocument document = parsed(xml, geom);
  const XmlElement element = document.root(xml.at(geom).tag.name);
  WorldShape shape{geom, lower_case(element.required_attribute("type")), {}, {}, {}, read_pose(element), {}};
  if (const auto sides = numbers_in(element, "extents")) {
    for (const double half : *sides) {
      shape.size.push_back(2.0 * half);
    }
  }
  for (const std::string_view tag : {"radius", "height"}) {
    if (const auto number = numbers_in(element, tag); number && number->size() == 1) {
      shape.size.push_back(number->front());
    }
  }
  if (const auto friction = numbers_in(element, "friction"); friction && friction->size() == 1) {
    shape.friction = friction->front();
  }
  if (const auto colour = numbers_in(element, "diffuseColor"); colour && colour->size() == 3) {
    shape.colour = Eigen::Vector3d((*colour)[0], (*colour)[1], (*colour)[2]);
  }
  return shape;
}

const std::vector<Geometry>& geometries_of(const EnvironmentModel& environment, const WorldObject& object) {
  return object.moves ? environment.moving_objects[object.index].geometries
                      : environment.objects[object.index].geometries;
}

/// The sizes of meshes, which only the scenario has. The reader has a geometry for each <Geom> that touches.
void add_mesh_sizes(const XmlText& xml, const EnvironmentModel& environment, WorldObject& object) {
  std::size_t number = 0;
  const std::vector<Geometry>& geometries = geometries_of(environment, object);
  for (WorldShape& shape : object.shapes) {
    const bool is_mesh = shape.type == "trimesh";
    const bool is_of_file = xml.child(shape.element, "data") || xml.child(shape.element, "collision");
    if (is_mesh && !is_of_file && !xml.child(shape.element, "vertices")) {
      continue;
    }
    if (is_mesh && is_of_file && number < geometries.size() && geometries[number].mesh) {
      const Bounds bounds = bounds_of(*geometries[number].mesh, {});
      shape.mesh_box = std::pair(bounds.lowest, bounds.highest);
      const Eigen::Vector3d sides = bounds.highest - bounds.lowest;
      shape.size = {sides.x(), sides.y(), sides.z()};
    }
    ++number;
  }
}

/// An object of the scenario; the reader keeps those that move apart.
struct ReadObject {
  WorldObject object;
  bool is_found = false;  ///< its element is known
};

std::vector<ReadObject> read_objects(const EnvironmentModel& environment) {
  std::vector<ReadObject> all;
  const auto add = [&all](const auto& body, std::size_t index, bool moves, double mass) {
    WorldObject object;
    object.name = body.name;
    object.file = body.file;
    object.line = body.line;
    object.moves = moves;
    object.index = index;
    object.mass = mass;
    object.pose = body.pose;
    all.push_back({std::move(object)});
  };
  for (std::size_t i = 0; i < environment.objects.size(); ++i) {
    add(environment.objects[i], i, false, 0.0);
  }
  for (std::size_t i = 0; i < environment.moving_objects.size(); ++i) {
    add(environment.moving_objects[i], i, true, environment.moving_objects[i].mass.mass);
  }
  return all;
}

/// The outermost <KinBody> of a body, directly in the environment.
std::optional<ElementNumber> group_of(const XmlText& xml, ElementNumber body) {
  ElementNumber at = body;
  while (xml.at(at).parent && *xml.at(at).parent != 0) {
    at = *xml.at(at).parent;
  }
  return at == body ? std::nullopt : std::optional(at);
}

std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> read_start(std::string_view comment) {
  std::string numbers(comment.substr(comment.find(':') + 1));
  std::ranges::replace(numbers, ',', ' ');
  std::vector<double> values;
  for (const std::string_view word : words(numbers)) {
    if (const auto value = parse_number(word)) {
      values.push_back(*value);
    }
  }
  if (values.size() != 6) {
    return std::nullopt;
  }
  return std::pair(Eigen::Vector3d(values[0], values[1], values[2]), Eigen::Vector3d(values[3], values[4], values[5]));
}

}  // namespace

WorldContents read_world_contents(const Draft& draft) {
  WorldContents world;
  const Scenario& scenario = draft.scenario();
  world.file = scenario.environment_file;
  const XmlText xml(world.file, draft.text(world.file));
  std::vector<ReadObject> all = read_objects(scenario.environment);
  for (ElementNumber i = 0; i < xml.size(); ++i) {
    if (xml.is(i, "ruler") && xml.at(i).parent == ElementNumber{0}) {
      const Ruler& ruler = scenario.environment.rulers.at(world.rulers.size());
      world.rulers.push_back({i, ruler.from, ruler.to});
    }
    if (!xml.is(i, "Body")) {
      continue;
    }
    const bool moves = lower_case(xml.attribute(i, "type").value_or("")) == "dynamic";
    const auto read = std::ranges::find_if(all, [&](const ReadObject& candidate) {
      return !candidate.is_found && candidate.object.moves == moves && candidate.object.file == world.file &&
             candidate.object.line == xml.at(i).tag.line;
    });
    if (read == all.end()) {
      continue;
    }
    read->is_found = true;
    WorldObject& object = read->object;
    object.body = i;
    object.group = group_of(xml, i);
    for (const ElementNumber geom : xml.children(i, "Geom")) {
      object.shapes.push_back(read_shape(xml, geom));
    }
    add_mesh_sizes(xml, scenario.environment, object);
    world.objects.push_back(std::move(object));
  }
  for (ReadObject& read : all) {
    if (!read.is_found) {
      world.objects.push_back(std::move(read.object));
    }
  }
  for (WorldObject& object : world.objects) {
    if (object.group) {
      object.group_size = static_cast<std::size_t>(
          std::ranges::count(world.objects, object.group, [](const WorldObject& other) { return other.group; }));
    }
  }
  if (const auto comment = xml.comment_with("pose:")) {
    if (const auto start =
            read_start(std::string_view(xml.text()).substr(comment->begin, comment->end - comment->begin))) {
      std::tie(world.start, world.start_degrees) = *start;
    }
  }
  return world;
}

}  // namespace proleg::sim
