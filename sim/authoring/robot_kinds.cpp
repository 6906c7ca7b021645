#include "sim/authoring/robot_kinds.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/authoring/shipped_modules.hpp"

namespace proleg::sim {
namespace {

constexpr std::string_view caterpillar_comment =
    R"(     The values are those of the shipped travelling_wave. From the 2013 thesis: 72 mm between joints, 0.4 Nm, 4.5 rad/s
     and the limits. FITTED to the displacements that the thesis reports: the masses, the shape of what touches the
     ground (modules/) and the gain of the servos.
)";

constexpr std::string_view cubo_comment =
    R"(     The CUBO robot of the 2013 thesis (section 3.1.4): cubes with small feet whose rubber grips the ground. The thesis
     prints no dimension of it. CHOSEN: 60 mm between joints, bodies of 50 mm, feet of 8 mm, a coefficient of 0.9 for
     the rubber and 0.2 for the body, 100 g for a module, and the servos of the shipped travelling_wave.
)";

constexpr std::string_view cube_chain_comment =
    R"(     The simple model of the 2013 thesis (section 3.1.4): a chain of cubes, which needs little computing time. The
     thesis prints no dimension of it. CHOSEN: cubes of 52 mm (the section of its module files), 60 mm between joints,
     100 g for a cube, and the servos of the shipped travelling_wave.
)";

constexpr std::string_view y1_comment =
    R"(     A robot of Y1 modules, as the thesis's detailed model (section 3.1.4). From the 2013 thesis: 52 mm wide and 72 mm
     between joints (its module files), 0.4 Nm and 4.5 rad/s. CHOSEN: the shape of the chassis (modules/y1_segment.off,
     a body with ears at its joints and chamfered edges), which is not that of the OpenMR plug-in, and 100 g for a
     module. What touches the ground is the convex hull of the mesh.
)";

constexpr std::string_view snake_comment =
    R"(     A snake whose joints alternate between pitch and yaw. The modules are those of the shipped travelling_wave. From
     the 2013 thesis: 72 mm between joints, 0.4 Nm, 4.5 rad/s and the limits. FITTED there: the masses, the shape of
     what touches the ground (modules/) and the gain of the servos.
)";

constexpr std::array<RobotKind, 5> kinds{
    {{"caterpillar", "joints that bend up and down, as in the experiments of the thesis", "p", 5, 72, "0.4", "4.5",
      caterpillar_comment},
     {"cubo", "cubes on feet of rubber, as the CUBO robot", "p", 5, 60, "0.4", "4.5", cubo_comment},
     {"cube-chain", "plain cubes, the fastest to simulate", "p", 7, 60, "0.4", "4.5", cube_chain_comment},
     {"y1", "modules with the shape of a chassis, as the Y1 robot", "p", 5, 72, "0.4", "4.5", y1_comment},
     {"snake", "joints that bend up and down and to the sides in turn", "py", 8, 72, "0.4", "4.5", snake_comment}}};

/// A place in the chain: the module's name, and the position of its middle from its origin, in half modules.
struct Place {
  std::string_view file;
  std::string_view body;
  double middle;
  std::string_view comment;
};

constexpr std::array<Place, 3> places{
    {{"tail", "Tail", -1.0, "The last link; the origin is at its joint, and the link lies towards negative y."},
     {"segment", "Seg", 1.0, "A link between two joints along y; the origin is at the joint towards the tail."},
     {"head", "Head", 1.0, "The first link; the origin is at its joint, and the link lies towards positive y."}}};

/// Text of a length in metres, from millimetres.
std::string metres(double millimetres) { return number_text(millimetres / 1000.0); }

std::string point(double x_mm, double y_mm, double z_mm) {
  return metres(x_mm) + ' ' + metres(y_mm) + ' ' + metres(z_mm);
}

std::string box_text(const std::string& middle, const std::string& half_sides, std::string_view friction) {
  std::string text = "    <Geom type=\"box\">\n      <translation>" + middle + "</translation>\n      <extents>" +
                     half_sides + "</extents>\n";
  if (!friction.empty()) {
    text.append("      <friction>").append(friction).append("</friction>\n");
  }
  return text + "    </Geom>\n";
}

/// A module with these geometries, and the mass of a solid box with these half sides.
SourceFile module_file(const Place& place, std::string_view comment, const std::string& geometries,
                       const std::string& middle, const std::string& half_sides) {
  std::string text = "<!-- ";
  text.append(place.comment).append("\n     ").append(comment).append(" Extents are half the side lengths. -->\n");
  text.append("<KinBody name=\"").append(place.file).append("\">\n  <Body name=\"").append(place.body);
  text += "\" type=\"dynamic\">\n" + geometries;
  text += "    <Mass type=\"box\">\n      <total>0.1</total>\n      <com>" + middle + "</com>\n      <extents>" +
          half_sides + "</extents>\n    </Mass>\n  </Body>\n</KinBody>\n";
  return {"modules/" + std::string(place.file) + ".kinbody.xml", text};
}

std::vector<SourceFile> cube_modules(const RobotKind& kind) {
  std::vector<SourceFile> files;
  for (const Place& place : places) {
    const std::string middle = point(0, place.middle * static_cast<double>(kind.module_mm) / 2.0, 0);
    const std::string half_sides = point(26, 26, 26);
    files.push_back(
        module_file(place, "A solid cube of 52 mm and 100 g.", box_text(middle, half_sides, ""), middle, half_sides));
  }
  return files;
}

std::vector<SourceFile> cubo_modules(const RobotKind& kind) {
  std::vector<SourceFile> files;
  for (const Place& place : places) {
    const double y = place.middle * static_cast<double>(kind.module_mm) / 2.0;
    const std::string middle = point(0, y, 0);
    std::string geometries = box_text(middle, point(25, 25, 25), "0.2");
    for (const double side : {-17.0, 17.0}) {
      for (const double end : {-13.0, 13.0}) {
        geometries += box_text(point(side, y + end, -28), point(4, 4, 3), "0.9");
      }
    }
    files.push_back(
        module_file(place, "A cube of 50 mm and 100 g on four feet of rubber.", geometries, middle, point(25, 25, 25)));
  }
  return files;
}

/// Text of an OFF file of prisms along y with corners (x, z), from y to y + length, all in mm.
struct OffText {
  std::string vertices;
  std::string sides;
  std::size_t count = 0;
  std::size_t side_count = 0;

  void add_prism(const std::vector<std::array<double, 2>>& corners, double from, double to) {
    const std::size_t first = count;
    const std::size_t n = corners.size();
    for (const double y : {from, to}) {
      for (const auto& [x, z] : corners) {
        vertices += point(x, y, z) + '\n';
      }
    }
    count += 2 * n;
    std::string front = std::to_string(n);
    std::string rear = front;
    for (std::size_t i = 0; i < n; ++i) {
      front += ' ' + std::to_string(first + i);
      rear += ' ' + std::to_string(first + 2 * n - 1 - i);
      sides += "4 " + std::to_string(first + i) + ' ' + std::to_string(first + n + i) + ' ' +
               std::to_string(first + n + (i + 1) % n) + ' ' + std::to_string(first + (i + 1) % n) + '\n';
    }
    sides += front + '\n' + rear + '\n';
    side_count += n + 2;
  }

  [[nodiscard]] std::string text() const {
    return "OFF\n" + std::to_string(count) + ' ' + std::to_string(side_count) + " 0\n" + vertices + sides;
  }
};

/// The mesh of a Y1 module around its middle: the body, and two ears at each joint.
std::string y1_mesh() {
  OffText mesh;
  mesh.add_prism({{20, -26}, {26, -20}, {26, 20}, {20, 26}, {-20, 26}, {-26, 20}, {-26, -20}, {-20, -26}}, -22, 22);
  for (const double side : {-1.0, 1.0}) {
    const double from = side > 0 ? 23.0 : -26.0;
    mesh.add_prism({{from + 3, -12}, {from + 3, 12}, {from, 12}, {from, -12}}, -34, -22);
    mesh.add_prism(
        {{12, side * 24.5 - 1.5}, {12, side * 24.5 + 1.5}, {-12, side * 24.5 + 1.5}, {-12, side * 24.5 - 1.5}}, 22, 34);
  }
  return mesh.text();
}

std::vector<SourceFile> y1_modules(const RobotKind& kind) {
  std::vector<SourceFile> files;
  for (const Place& place : places) {
    const std::string middle = point(0, place.middle * static_cast<double>(kind.module_mm) / 2.0, 0);
    const std::string geometry =
        "    <Geom type=\"trimesh\">\n      <translation>" + middle +
        "</translation>\n      <data>y1_segment.off</data>\n      <diffuseColor>0.75 0.75 0.7</diffuseColor>\n"
        "    </Geom>\n";
    files.push_back(module_file(place, "A Y1 module of 100 g: shown as its mesh, in contact as the convex hull of it.",
                                geometry, middle, point(26, 30, 26)));
  }
  files.push_back({"modules/y1_segment.off", y1_mesh()});
  return files;
}

}  // namespace

std::span<const RobotKind> robot_kinds() { return kinds; }

const RobotKind* find_robot_kind(std::string_view name) {
  const auto found = std::ranges::find(kinds, name, &RobotKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

std::vector<SourceFile> module_files(const RobotKind& kind) {
  if (kind.name == "cubo") {
    return cubo_modules(kind);
  }
  if (kind.name == "cube-chain") {
    return cube_modules(kind);
  }
  if (kind.name == "y1") {
    return y1_modules(kind);
  }
  return {{"modules/tail.kinbody.xml", std::string(tail_text())},
          {"modules/segment.kinbody.xml", std::string(segment_text())},
          {"modules/head.kinbody.xml", std::string(head_text())}};
}

}  // namespace proleg::sim
