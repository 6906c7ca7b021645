#include "sim/authoring/world_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/mesh_reader.hpp"
#include "sim/scenario/values.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

void require_place(const Eigen::Vector3d& position, double turn_degrees) {
  if (!position.allFinite() || !(position.cwiseAbs().maxCoeff() <= coordinates.max) ||
      !(std::abs(turn_degrees) <= turns.max)) {
    throw InputError("position", 0, "a place that is out of range", "coordinates up to 10000 m, degrees up to 360");
  }
}

/// By how much the sides of a mesh grow. A sheet that lies flat has a side of no length, which stays.
Eigen::Vector3d growth_of_mesh(const WorldShape& shape, const std::vector<double>& size) {
  const Eigen::Vector3d before = shape.mesh_box->second - shape.mesh_box->first;
  Eigen::Vector3d growth = Eigen::Vector3d::Ones();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    growth[axis] = before[axis] > 0.0 ? size[static_cast<std::size_t>(axis)] / before[axis] : 1.0;
  }
  return growth;
}

/// The middle of the box around a mesh of this size, in its frame: a scale is about the origin of the mesh.
Eigen::Vector3d middle_of_mesh(const WorldShape& shape, const std::vector<double>& size) {
  return growth_of_mesh(shape, size).cwiseProduct((shape.mesh_box->first + shape.mesh_box->second) / 2.0);
}

/// The lowest point of an object's boxes, spheres, cylinders and boxes around meshes, in m; nothing if it has other
/// shapes.
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
    } else if (shape.mesh_box && size.size() == 3) {
      solid.extents = Eigen::Vector3d(size[0], size[1], size[2]) / 2.0;
      solid.pose = shape.pose * Pose{middle_of_mesh(shape, size), Eigen::Quaterniond::Identity()};
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
  for (std::size_t i = 0; i < size.size(); ++i) {
    const bool is_flat = shape.mesh_box && shape.size[i] == 0.0 && size[i] == 0.0;
    if (!is_flat && !(size[i] >= 2.0 * lengths.min && size[i] <= lengths.max)) {
      throw InputError("size", 0, number_text(size[i]), "lengths up to " + number_text(lengths.max) + " m, above 0");
    }
  }
  std::vector<WorldShape> resized = found.shapes;
  WorldShape& changed = resized[shape_number];
  changed.size = size;
  if (shape.mesh_box) {
    // The middle stays where it is.
    changed.pose.position += shape.pose.orientation * (middle_of_mesh(shape, shape.size) - middle_of_mesh(shape, size));
    set_pose(change_, world_.file, shape.element, changed.pose);
  }
  const std::optional<double> bottom = lowest_point(found.pose, found.shapes);
  const std::optional<double> new_bottom = lowest_point(found.pose, resized);
  write_size(shape, size);
  if (bottom && new_bottom) {
    Pose pose = found.pose;
    pose.position.z() += *bottom - *new_bottom;
    place(number, pose, false);
  }
}

void WorldChange::write_scale(const WorldShape& shape, const std::vector<double>& size) {
  const std::optional<ElementNumber> data = xml().child(shape.element, "data");
  const ElementNumber element = data ? *data : xml().child(shape.element, "collision").value();
  const std::string text = content_of(xml(), element);
  const std::filesystem::path folder = std::filesystem::path(world_.file).parent_path();
  const auto is_file = [&](const std::string& path) { return change_.read(name_of(folder / path)).has_value(); };
  const FileText split = split_file_text(text, is_file);
  std::vector<double> scale;
  for (const std::string_view word : words(split.rest)) {
    scale.push_back(parse_number(word).value_or(1.0));
  }
  scale.resize(3, scale.size() == 1 ? scale.front() : 1.0);
  const Eigen::Vector3d growth = growth_of_mesh(shape, size);
  std::string numbers;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Coordinates of meshes have the seven digits of single precision.
    std::array<char, 40> number{};
    std::snprintf(number.data(), number.size(), " %.7g", scale[axis] * growth[static_cast<Eigen::Index>(axis)]);
    numbers += number.data();
  }
  const std::vector<std::string_view> parts = words(numbers);
  if (parts[0] == parts[1] && parts[1] == parts[2]) {
    numbers = " " + std::string(parts[0]);
  }
  apply(xml().set_content(element, escaped_xml(std::string(split.path) + numbers)));
}

void WorldChange::write_size(const WorldShape& shape, const std::vector<double>& size) {
  if (shape.mesh_box) {
    write_scale(shape, size);
    return;
  }
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
  const std::vector<ElementNumber> elements = elements_of(world_, objects, with_group);
  for (std::size_t i = elements.size(); i-- > 0;) {
    apply(xml().remove(elements[i]));
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
  const std::vector<ElementNumber> originals = elements_of(world_, objects, with_group);
  for (std::size_t at = originals.size(); at-- > 0;) {
    const ElementNumber original = originals[at];
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
  require_place(position, turn_degrees);
  add_object(change_, world_.file,
             item_text(item, checked, free_name(std::string(declaration.name)), position, turn_degrees));
}

void WorldChange::add_mesh(const OwnMesh& mesh, const MeshFit& fit, bool is_sheet, const Eigen::Vector3d& position,
                           double turn_degrees) {
  require_fit(fit);
  require_place(position, turn_degrees);
  const std::string& name = mesh.files.front().name;
  if (mesh.facts.flaw) {
    throw InputError(name, 0, *mesh.facts.flaw, "triangles whose corners are not on one line");
  }
  if (mesh.facts.gap && !is_sheet) {
    throw InputError(name, 0, *mesh.facts.gap, "a closed surface, or to be a sheet, which touches from one side");
  }
  if (is_sheet && !((fit.rotation() * mesh.facts.facing).z() > 0.0)) {
    throw InputError(name, 0, "a sheet whose triangles face down, so that a robot would fall through it",
                     "one that faces up: two turns of 90 degrees about x turn it over");
  }
  const FittedBox box = fitted_box(mesh.facts, fit);
  const Eigen::Vector3d middle = (box.lowest + box.highest) / 2.0;
  const std::filesystem::path parent = std::filesystem::path(world_.file).parent_path();
  const std::string folder = add_in_free_folder(change_, parent, "meshes", source_files(mesh));
  const std::string lines = mesh_lines(folder + "/" + name, fit, {-middle.x(), -middle.y(), -box.lowest.z()}) +
                            element_text("friction", "0.5");
  std::string geom = is_sheet ? "<Geom type=\"trimesh\" open=\"1\">" : "<Geom type=\"trimesh\">";
  std::string_view rest = lines;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    geom += "\n      " + std::string(line);
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
  }
  const double turn = turn_degrees * std::numbers::pi / 180.0;
  const double half_depth = (box.highest - box.lowest).y() / 2.0;
  const Eigen::Vector3d place = position + half_depth * Eigen::Vector3d(-std::sin(turn), std::cos(turn), 0.0);
  std::string text = "<KinBody name=\"" + escaped_xml(free_name(shortened(name.substr(0, name.rfind('.'))))) + "\">\n";
  text += "  " + element_text("Translation", vector_text(place)) + "\n";
  if (turn_degrees != 0.0) {
    text += "  " + element_text("RotationAxis", "0 0 1 " + number_text_of(turn_degrees)) + "\n";
  }
  text += "  <Body type=\"static\">\n    " + geom + "\n    </Geom>\n  </Body>\n</KinBody>";
  add_object(change_, world_.file, text);
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
