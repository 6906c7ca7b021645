#include "sim/authoring/world_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <ranges>
#include <set>
#include <span>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/values.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

/// The lowest point of an object's boxes, spheres and cylinders, in m; nothing if it has other shapes.
std::optional<double> lowest_point(const Pose& pose, const std::vector<WorldShape>& shapes) {
  std::optional<double> lowest;
  for (const WorldShape& shape : shapes) {
    const std::vector<double>& size = shape.size;
    Geometry solid;
    solid.pose = shape.pose;
    if (shape.type == "box" && size.size() == 3) {
      solid.extents = Eigen::Vector3d(size[0], size[1], size[2]) / 2.0;
    } else if (shape.type == "sphere" && size.size() == 1) {
      solid.shape = Shape::sphere;
      solid.extents = {size[0], 0.0, 0.0};
    } else if (shape.type == "cylinder" && size.size() == 2) {
      solid.shape = Shape::cylinder;
      solid.extents = {size[0], size[1] / 2.0, 0.0};
    } else {
      return std::nullopt;
    }
    const double bottom = bounds_of(solid, pose).lowest.z();
    lowest = std::min(lowest.value_or(bottom), bottom);
  }
  return lowest;
}

const WorldObject& editable_object(const WorldContents& world, std::size_t number) {
  if (number >= world.objects.size()) {
    throw InputError("object", 0, std::to_string(number),
                     "a number below " + std::to_string(world.objects.size()) + ", of an object of the world");
  }
  const WorldObject& found = world.objects[number];
  if (!found.body) {
    throw InputError("object", 0, in_quotes(found.name) + " is in " + found.file,
                     "an object of " + world.file + "; other worlds may use that file, too");
  }
  return found;
}

}  // namespace

std::vector<ElementNumber> elements_of(const WorldContents& world, const std::vector<std::size_t>& objects,
                                       bool with_group) {
  std::set<ElementNumber> elements;
  for (const std::size_t number : objects) {
    const WorldObject& found = editable_object(world, number);
    const bool whole = found.group && (with_group || found.group_size == 1);
    elements.insert(whole ? *found.group : *found.body);
  }
  if (elements.empty()) {
    throw InputError("objects", 0, "none", "at least one object of the world");
  }
  return {elements.begin(), elements.end()};
}

ElementNumber add_object(DraftChange& change, const std::string& file, const std::string& lines) {
  const std::vector<ElementNumber> all = change.xml(file).children(0, "KinBody");
  if (all.empty()) {
    change.apply(file, change.xml(file).add_last(0, lines));
    return change.xml(file).children(0).back();
  }
  change.apply(file, change.xml(file).add_behind(all.back(), lines));
  return next_sibling(change.xml(file), all.back());
}

void WorldChange::place(std::size_t number, const Pose& pose, bool with_group) {
  const WorldObject& found = editable_object(world_, number);
  if (with_group && found.group) {
    // The whole group turns and moves as its body does.
    const Pose of_group = pose_of(xml(), *found.group);
    set_pose(change_, world_.file, *found.group, pose * found.pose.inverse() * of_group);
    return;
  }
  const Pose local = pose_of(xml(), *found.body);
  const Pose frame = found.pose * local.inverse();
  set_pose(change_, world_.file, *found.body, frame.inverse() * pose);
}

void WorldChange::set_size(std::size_t number, std::size_t shape_number, const std::vector<double>& size) {
  const WorldObject& found = editable_object(world_, number);
  if (shape_number >= found.shapes.size()) {
    throw InputError("shape", 0, std::to_string(shape_number), "a number below " + std::to_string(found.shapes.size()));
  }
  const WorldShape& shape = found.shapes[shape_number];
  if (size.size() != shape.size.size() || size.empty()) {
    throw InputError("size", 0, std::to_string(size.size()) + " numbers for " + in_quotes(shape.type),
                     shape.size.empty() ? "a shape that has a size" : std::to_string(shape.size.size()) + " numbers");
  }
  for (const double length : size) {
    if (!(length >= 2.0 * lengths.min && length <= lengths.max)) {
      throw InputError("size", 0, number_text(length), "lengths up to " + number_text(lengths.max) + " m, above 0");
    }
  }
  std::vector<WorldShape> resized = found.shapes;
  resized[shape_number].size = size;
  const std::optional<double> bottom = lowest_point(found.pose, found.shapes);
  const std::optional<double> new_bottom = lowest_point(found.pose, resized);
  write_size(shape, size);
  if (bottom && new_bottom) {
    Pose pose = found.pose;
    pose.position.z() += *bottom - *new_bottom;
    place(number, pose, false);
  }
}

void WorldChange::write_size(const WorldShape& shape, const std::vector<double>& size) {
  if (shape.type == "box" || shape.type == "heightfield") {
    std::string halves;
    for (const double side : size) {
      halves += (halves.empty() ? "" : " ") + length_text(side / 2.0);
    }
    set_tag_of(shape.element, "extents", halves);
    return;
  }
  set_tag_of(shape.element, "radius", length_text(size[0]));
  if (size.size() > 1) {
    set_tag_of(shape.element, "height", length_text(size[1]));
  }
}

void WorldChange::set_friction(std::size_t number, std::optional<double> friction) {
  const WorldObject& found = editable_object(world_, number);
  // From the last on, because tags that are added or removed change the numbers of those behind them.
  for (std::size_t i = found.shapes.size(); i-- > 0;) {
    set_friction_of(change_, world_.file, found.shapes[i].element, friction);
  }
}

void WorldChange::set_colour(std::size_t number, const Eigen::Vector3d& colour) {
  const WorldObject& found = editable_object(world_, number);
  for (std::size_t i = found.shapes.size(); i-- > 0;) {
    set_tag_of(found.shapes[i].element, "diffuseColor", vector_text(colour));
  }
}

void WorldChange::set_moves(std::size_t number, bool moves) {
  const WorldObject& found = editable_object(world_, number);
  if (moves && !xml().child(*found.body, "Mass")) {
    constexpr std::string_view usual_mass = "<Mass type=\"mimicgeom\">\n  <density>500</density>\n</Mass>";
    apply(xml().add_last(*found.body, usual_mass));
  }
  apply(xml().set_attribute(*found.body, "type", moves ? "dynamic" : "static"));
}

void WorldChange::set_mass(std::size_t number, double mass) {
  const WorldObject& found = editable_object(world_, number);
  const std::optional<ElementNumber> element = xml().child(*found.body, "Mass");
  if (!found.moves || !element) {
    throw InputError("mass", 0,
                     "object " + in_quotes(found.name) + (found.moves ? " without a <Mass>" : ", which does not move"),
                     "an object that moves and has a mass of its own");
  }
  set_mass_of(change_, world_.file, *element, mass);
}

void WorldChange::rename(std::size_t number, const std::string& name) {
  const WorldObject& found = editable_object(world_, number);
  if (name.empty() || !is_visible_line(name) || shortened(name) != name) {
    throw InputError("name", 0, in_quotes(name), "1 to 60 characters that a person sees");
  }
  const bool is_group_name = !xml().attribute(*found.body, "name") && found.group && found.group_size == 1 &&
                             xml().at(*found.body).parent == found.group;
  apply(xml().set_attribute(is_group_name ? *found.group : *found.body, "name", name));
}

void WorldChange::remove(const std::vector<std::size_t>& objects, bool with_group) {
  // An edit does not move the elements before it.
  for (const ElementNumber element : std::views::reverse(elements_of(world_, objects, with_group))) {
    apply(xml().remove(element));
  }
}

std::string WorldChange::free_name(const std::string& wanted) const {
  std::set<std::string> taken;
  for (const WorldObject& found : world_.objects) {
    taken.insert(found.name);
  }
  std::string name = wanted;
  for (unsigned i = 2; taken.contains(name); ++i) {
    name = wanted + " " + std::to_string(i);
  }
  return name;
}

void WorldChange::duplicate(const std::vector<std::size_t>& objects, bool with_group, const Eigen::Vector3d& step,
                            unsigned count) {
  constexpr unsigned most_copies = 200;
  if (count < 1 || count > most_copies) {
    throw InputError("count", 0, std::to_string(count), "1 to " + std::to_string(most_copies));
  }
  // An edit does not move the elements before it.
  for (const ElementNumber original : std::views::reverse(elements_of(world_, objects, with_group))) {
    const auto body = std::ranges::find(world_.objects, original, &WorldObject::body);
    const Pose local = pose_of(xml(), original);
    const Pose frame = body == world_.objects.end() ? Pose{} : body->pose * local.inverse();
    // From the last copy on, each directly behind the original.
    for (unsigned i = count; i > 0; --i) {
      const std::string lines = unindented(xml(), original);
      apply(xml().add_behind(original, lines));
      Pose moved = local;
      moved.position += frame.inverse().orientation * (static_cast<double>(i) * step);
      set_pose(change_, world_.file, next_sibling(xml(), original), moved);
    }
  }
}

void WorldChange::add(LibraryItem item, const std::map<std::string, double>& values, const Eigen::Vector3d& position,
                      double turn_degrees) {
  const LibraryDeclaration& declaration = library().at(static_cast<std::size_t>(item));
  std::map<std::string, double> checked;
  for (const LibraryParameter& parameter : declaration.parameters) {
    checked.emplace(parameter.name, parameter.usual);
  }
  for (const auto& [name, value] : values) {
    const auto parameter = std::ranges::find(declaration.parameters, name, &LibraryParameter::name);
    if (parameter == declaration.parameters.end()) {
      throw InputError("values", 0, in_quotes(name), "parameters of " + in_quotes(declaration.name));
    }
    if (!(value >= parameter->lowest && value <= parameter->highest) ||
        (parameter->is_whole && value != std::floor(value))) {
      throw InputError(name, 0, number_text(value),
                       (parameter->is_whole ? "a whole number from " : "a number from ") +
                           number_text(parameter->lowest) + " to " + number_text(parameter->highest));
    }
    checked[name] = value;
  }
  if (!position.allFinite() || !(position.cwiseAbs().maxCoeff() <= coordinates.max) ||
      !(std::abs(turn_degrees) <= turns.max)) {
    throw InputError("position", 0, "a place that is out of range", "coordinates up to 10000 m, degrees up to 360");
  }
  add_object(change_, world_.file,
             item_text(item, checked, free_name(std::string(declaration.name)), position, turn_degrees));
}

void WorldChange::add_ruler(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const std::string lines = "<ruler>\n  " + element_text("from", vector_text(from)) + "\n  " +
                            element_text("to", vector_text(to)) + "\n</ruler>";
  apply(xml().add_last(0, lines));
}

void WorldChange::set_ruler(std::size_t ruler, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const ElementNumber element = element_of_ruler(ruler);
  set_tag_of(element, "from", vector_text(from));
  set_tag_of(element, "to", vector_text(to));
}

void WorldChange::remove_ruler(std::size_t ruler) { apply(xml().remove(element_of_ruler(ruler))); }

ElementNumber WorldChange::element_of_ruler(std::size_t ruler) const {
  if (ruler >= world_.rulers.size()) {
    throw InputError("ruler", 0, std::to_string(ruler), "a number below " + std::to_string(world_.rulers.size()));
  }
  return world_.rulers[ruler].element;
}

void WorldChange::set_start(const Eigen::Vector3d& position, const Eigen::Vector3d& degrees) {
  const std::string comment = "<!--Pose: ," + vector_text(position) + "," + vector_text(degrees) + ",-->";
  if (const auto range = xml().comment_with("pose:")) {
    apply(xml().replace(*range, comment));
    return;
  }
  const std::string& text = xml().text();
  const TextRange end{text.size(), text.size()};
  apply(xml().replace(end, (text.ends_with('\n') ? "" : "\n") + comment + "\n"));
}

}  // namespace proleg::sim
