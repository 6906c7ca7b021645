#include "sim/authoring/library_items.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/random.hpp"
#include "sim/authoring/scenario_text.hpp"

namespace proleg::sim {
namespace {

using Values = std::map<std::string, double>;

constexpr std::string_view usual_colour = "0.6 0.5 0.4";

constexpr LibraryParameter of_friction{"friction", "How slippery it is: 0 is ice, 1 is rubber.", "", 0.0, 10.0, 0.5};
constexpr LibraryParameter of_width{"width", "Across the way of the robot.", "m", 0.01, 1000.0, 1.0};

std::string indented_twice(const std::string& lines) {
  std::string result = "    ";
  for (const char character : lines) {
    result += character;
    result += character == '\n' ? "    " : "";
  }
  return result;
}

std::string geom(std::string_view type, const std::string& size, const Values& values) {
  return "<Geom type=\"" + std::string(type) + "\">\n  " + size + "\n  " + element_text("diffuseColor", usual_colour) +
         "\n  " + element_text("friction", number_text_of(values.at("friction"))) + "\n</Geom>";
}

std::string box(const Eigen::Vector3d& sides, const Values& values) {
  return geom("box",
              "<extents>" + length_text(sides.x() / 2.0) + " " + length_text(sides.y() / 2.0) + " " +
                  length_text(sides.z() / 2.0) + "</extents>",
              values);
}

struct BodyPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double degrees_about_x = 0.0;
};

/// A body in a group, with the indentation of a group's child.
std::string body(const BodyPlace& place, const std::string& shape) {
  std::string text = "  <Body type=\"static\">\n";
  if (!place.position.isZero()) {
    text += "    " + element_text("Translation", vector_text(place.position)) + "\n";
  }
  if (place.degrees_about_x != 0.0) {
    text += "    " + element_text("RotationAxis", "1 0 0 " + number_text_of(place.degrees_about_x)) + "\n";
  }
  return text + indented_twice(shape) + "\n  </Body>\n";
}

/// A flat piece whose upper face goes from one point (y, z) to another.
std::string piece(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double thickness, const Values& values) {
  const Eigen::Vector2d along = to - from;
  const double angle = std::atan2(along.y(), along.x());
  const Eigen::Vector2d down(std::sin(angle), -std::cos(angle));
  const Eigen::Vector2d middle = (from + to) / 2.0 + thickness / 2.0 * down;
  return body({{0.0, middle.x(), middle.y()}, angle * 180.0 / std::numbers::pi},
              box({values.at("width"), along.norm(), thickness}, values));
}

std::string ramp(const Values& values) {
  constexpr double thickness = 0.02;
  const double length = values.at("length");
  return piece({0.0, 0.0}, {length, length * std::tan(values.at("slope") * std::numbers::pi / 180.0)}, thickness,
               values);
}

std::string stairs(const Values& values) {
  const double depth = values.at("depth");
  std::string text;
  for (int i = 0; i < static_cast<int>(values.at("steps")); ++i) {
    const double height = (i + 1) * values.at("rise");
    text += body({{0.0, (i + 0.5) * depth, height / 2.0}, 0.0}, box({values.at("width"), depth, height}, values));
  }
  return text;
}

std::string hills(const Values& values) {
  constexpr int pieces = 10;
  constexpr double thickness = 0.02;
  const double length = values.at("length");
  std::string text;
  for (int hill = 0; hill < static_cast<int>(values.at("hills")); ++hill) {
    const auto point = [&](int i) {
      const double share = static_cast<double>(i) / pieces;
      return Eigen::Vector2d((hill + share) * length,
                             values.at("height") / 2.0 * (1.0 - std::cos(2.0 * std::numbers::pi * share)));
    };
    for (int i = 0; i < pieces; ++i) {
      text += piece(point(i), point(i + 1), thickness, values);
    }
  }
  return text;
}

/// Random heights on a grid of a tenth of a metre, with a cosine between them, that end at height 0 at the edges.
std::string rough(const Values& values) {
  constexpr double cell = 0.05;
  constexpr int cells_of_hill = 3;
  const auto points_along = [](double side) { return std::max(4, static_cast<int>(std::lround(side / cell)) + 1); };
  const int columns = points_along(values.at("width"));
  const int rows = points_along(values.at("length"));
  Pcg32 random(static_cast<std::uint64_t>(values.at("seed")), 1);
  const int nodes_x = columns / cells_of_hill + 2;
  const int nodes_y = rows / cells_of_hill + 2;
  std::vector<double> nodes(static_cast<std::size_t>(nodes_x) * static_cast<std::size_t>(nodes_y));
  std::ranges::generate(nodes, [&random] { return std::ldexp(static_cast<double>(random.next()), -32); });
  const auto blend = [](double share) { return (1.0 - std::cos(std::numbers::pi * share)) / 2.0; };
  std::string heights;
  for (int y = 0; y < rows; ++y) {
    heights += "        ";
    for (int x = 0; x < columns; ++x) {
      const int i = x / cells_of_hill;
      const int j = y / cells_of_hill;
      const double u = blend(static_cast<double>(x % cells_of_hill) / cells_of_hill);
      const double v = blend(static_cast<double>(y % cells_of_hill) / cells_of_hill);
      const auto node = [&](int column, int row) { return nodes[static_cast<std::size_t>(row * nodes_x + column)]; };
      const double height = (1.0 - v) * ((1.0 - u) * node(i, j) + u * node(i + 1, j)) +
                            v * ((1.0 - u) * node(i, j + 1) + u * node(i + 1, j + 1));
      const bool is_edge = x == 0 || y == 0 || x + 1 == columns || y + 1 == rows;
      heights += (x == 0 ? "" : " ") + coordinate_text(is_edge ? 0.0 : height * values.at("height"));
    }
    heights += "\n";
  }
  std::string text = "  <Body type=\"static\">\n    " +
                     element_text("Translation", vector_text({0.0, values.at("length") / 2.0, 0.0})) +
                     "\n    <Geom type=\"heightfield\">\n      <extents>" + length_text(values.at("width") / 2.0) +
                     " " + length_text(values.at("length") / 2.0) + "</extents>\n      " +
                     element_text("columns", std::to_string(columns)) + "\n      " +
                     element_text("rows", std::to_string(rows)) + "\n      <heights>\n" + heights +
                     "      </heights>\n      " + element_text("diffuseColor", usual_colour) + "\n      " +
                     element_text("friction", number_text_of(values.at("friction"))) + "\n    </Geom>\n  </Body>\n";
  return text;
}

std::string bodies(LibraryItem item, const Values& values) {
  switch (item) {
    case LibraryItem::box:
      return body({{0.0, 0.0, values.at("height") / 2.0}, 0.0},
                  box({values.at("width"), values.at("length"), values.at("height")}, values));
    case LibraryItem::ramp:
      return ramp(values);
    case LibraryItem::stairs:
      return stairs(values);
    case LibraryItem::cylinder:
      // The axis of a cylinder is y; across the way it is x.
      return "  <Body type=\"static\">\n    " +
             element_text("Translation", vector_text({0.0, 0.0, values.at("radius")})) + "\n    " +
             element_text("RotationAxis", "0 0 1 90") + "\n" +
             indented_twice(geom("cylinder",
                                 element_text("radius", length_text(values.at("radius"))) + "\n  " +
                                     element_text("height", length_text(values.at("width"))),
                                 values)) +
             "\n  </Body>\n";
    case LibraryItem::sphere:
      return body({{0.0, 0.0, values.at("radius")}, 0.0},
                  geom("sphere", element_text("radius", length_text(values.at("radius"))), values));
    case LibraryItem::hills:
      return hills(values);
    case LibraryItem::rough:
      return rough(values);
  }
  return {};
}

}  // namespace

const std::vector<LibraryDeclaration>& library() {
  static const std::vector<LibraryDeclaration> items{
      {LibraryItem::box,
       "box",
       "A box: a wall, a step, or something to push.",
       {of_width,
        {"length", "Along the way of the robot.", "m", 0.001, 1000.0, 0.2},
        {"height", "From the ground to its top.", "m", 0.001, 100.0, 0.03},
        of_friction}},
      {LibraryItem::ramp,
       "ramp",
       "A slope that begins on the ground.",
       {of_width,
        {"length", "On the ground, along the way of the robot.", "m", 0.05, 100.0, 1.0},
        {"slope", "How steep it is.", "degree", -60.0, 60.0, 10.0},
        of_friction}},
      {LibraryItem::stairs,
       "stairs",
       "Steps that go up.",
       {of_width,
        {"steps", "How many.", "", 1.0, 100.0, 3.0, true},
        {"rise", "The height of each.", "m", 0.001, 1.0, 0.03},
        {"depth", "The length of each, along the way of the robot.", "m", 0.01, 10.0, 0.3},
        of_friction}},
      {LibraryItem::cylinder,
       "cylinder",
       "A log that lies across the way.",
       {of_width, {"radius", "Half its thickness.", "m", 0.001, 10.0, 0.03}, of_friction}},
      {LibraryItem::sphere,
       "sphere",
       "A ball.",
       {{"radius", "Half its thickness.", "m", 0.001, 10.0, 0.05}, of_friction}},
      {LibraryItem::hills,
       "hills",
       "Waves across the way, as the obstacle of the thesis has them.",
       {of_width,
        {"hills", "How many.", "", 1.0, 50.0, 2.0, true},
        {"height", "Of each, above the ground.", "m", 0.001, 1.0, 0.03},
        {"length", "Of each, along the way of the robot.", "m", 0.02, 10.0, 0.4},
        of_friction}},
      {LibraryItem::rough,
       "rough ground",
       "A field of random bumps.",
       {{"width", "Across the way of the robot.", "m", 0.2, 10.0, 1.0},
        {"length", "Along the way of the robot.", "m", 0.2, 10.0, 1.0},
        {"height", "Of the highest bump.", "m", 0.001, 1.0, 0.03},
        {"seed", "Another number makes other bumps.", "", 0.0, 4294967295.0, 1.0, true},
        of_friction}}};
  return items;
}

const LibraryDeclaration* find_library_item(std::string_view name) {
  const auto found = std::ranges::find(library(), name, &LibraryDeclaration::name);
  return found == library().end() ? nullptr : &*found;
}

std::string item_text(LibraryItem item, const std::map<std::string, double>& values, const std::string& name,
                      const Eigen::Vector3d& position, double turn_degrees) {
  std::string text = "<KinBody name=\"" + escaped_xml(name) + "\">\n";
  if (!position.isZero()) {
    text += "  " + element_text("Translation", vector_text(position)) + "\n";
  }
  if (turn_degrees != 0.0) {
    text += "  " + element_text("RotationAxis", "0 0 1 " + number_text_of(turn_degrees)) + "\n";
  }
  return text + bodies(item, values) + "</KinBody>";
}

}  // namespace proleg::sim
