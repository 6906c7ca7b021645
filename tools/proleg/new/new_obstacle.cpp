#include "tools/proleg/new/new_files.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

/// A floor with hills and pits across the way of the robot, like the irregular obstacle of the thesis (figure 6.7),
/// whose dimensions it does not print.
struct Obstacle {
  /// Height of each hill above the floor in mm, in the order in which the robot meets them; a pit is below 0. The
  /// defaults are those of the shipped obstacle: two hills, the pit between them and the last hill, a last one.
  std::vector<double> heights_mm{32, 43, -43, 43};
  double length_mm = 400;  ///< length of each hill along the way of the robot
  double start_mm = 360;   ///< start of the first hill, from the position of the robot
  double width_mm = 2'000;
  unsigned segments = 10;  ///< number of flat pieces of each hill
  double friction = 0.6;   ///< friction of the hills
  double floor_friction = 0.1;
};

constexpr double thickness_mm = 20.0;

struct Point {
  double along;  ///< mm along the way of the robot
  double up;     ///< mm above the floor
};

/// Points of the surface, from the first point of the first hill to the last point of the last one.
std::vector<Point> surface(const Obstacle& obstacle) {
  std::vector<Point> points{{obstacle.start_mm, 0.0}};
  for (const double height : obstacle.heights_mm) {
    const double start = points.back().along;
    for (unsigned i = 1; i <= obstacle.segments; ++i) {
      const double share = static_cast<double>(i) / obstacle.segments;
      const double up = i == obstacle.segments ? 0.0 : height / 2.0 * (1.0 - std::cos(2.0 * std::numbers::pi * share));
      points.push_back({start + share * obstacle.length_mm, up});
    }
  }
  return points;
}

/// Text of a length in metres, rounded to a micrometre.
std::string metres(double mm) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6f", mm / 1000.0);
  return text.data();
}

std::string box_text(const std::string& translation, const std::string& rotation, const std::string& extents,
                     const char* colour, double friction) {
  return "    <Body type=\"static\">\n      <Translation>" + translation + "</Translation>\n" + rotation +
         "      <Geom type=\"box\">\n        <extents>" + extents + "</extents>\n        <diffuseColor>" + colour +
         "</diffuseColor>\n        <friction>" + number_text(friction) + "</friction>\n      </Geom>\n    </Body>\n";
}

std::string floor_text(double from_mm, double to_mm, const Obstacle& obstacle) {
  return box_text("0 " + metres((from_mm + to_mm) / 2.0) + " " + metres(-thickness_mm / 2.0), "",
                  metres(8'000) + " " + metres((to_mm - from_mm) / 2.0) + " " + metres(thickness_mm / 2.0), "0.3 1 0.3",
                  obstacle.floor_friction);
}

/// A flat piece of a hill. Its upper face is the line between the points.
std::string piece_text(const Point& from, const Point& to, const Obstacle& obstacle) {
  const double along = to.along - from.along;
  const double up = to.up - from.up;
  const double length = std::hypot(along, up);
  const double angle = std::atan2(up, along);
  const Point middle{(from.along + to.along) / 2.0 + thickness_mm / 2.0 * std::sin(angle),
                     (from.up + to.up) / 2.0 - thickness_mm / 2.0 * std::cos(angle)};
  std::array<char, 32> degrees{};
  std::snprintf(degrees.data(), degrees.size(), "%.6f", angle * 180.0 / std::numbers::pi);
  return box_text("0 " + metres(middle.along) + " " + metres(middle.up),
                  "      <RotationAxis>1 0 0 " + std::string(degrees.data()) + "</RotationAxis>\n",
                  metres(obstacle.width_mm / 2.0) + " " + metres(length / 2.0) + " " + metres(thickness_mm / 2.0),
                  "0.6 0.5 0.4", obstacle.friction);
}

std::string list_of_heights(const Obstacle& obstacle) {
  std::string text;
  for (const double height : obstacle.heights_mm) {
    text += (text.empty() ? "" : ", ") + number_text(height);
  }
  return text;
}

/// The environment file. Each hill is a wave of a cosine, made of flat boxes: any engine has boxes.
std::string obstacle_text(const Obstacle& obstacle) {
  constexpr double floor_start_mm = -8'000;
  constexpr double floor_length_mm = 16'000;
  const std::vector<Point> points = surface(obstacle);
  std::string text = "<!-- An irregular obstacle, written by proleg new obstacle. Along y come hills of " +
                     list_of_heights(obstacle) + " mm\n     (below 0: a pit), each " + number_text(obstacle.length_mm) +
                     " mm long; the first one starts at y = " + metres(obstacle.start_mm) +
                     " m. Each is a wave of a\n     cosine, made of " + std::to_string(obstacle.segments) +
                     " flat boxes. -->\n";
  text += R"(<Environment>
  <physicsengine type="ode">
    <odeproperties>
      <gravity>0 0 -9.81</gravity>
      <selfcollision>1</selfcollision>
    </odeproperties>
  </physicsengine>
  <KinBody name="floor">
)";
  text += floor_text(floor_start_mm, points.front().along, obstacle);
  text += floor_text(points.back().along, points.back().along + floor_length_mm, obstacle);
  text += "  </KinBody>\n  <KinBody name=\"obstacle\">\n";
  for (std::size_t i = 1; i < points.size(); ++i) {
    text += piece_text(points[i - 1], points[i], obstacle);
  }
  text += "  </KinBody>\n</Environment>\n";
  text += "<!-- Start of the robot: x y z in metres, then degrees about x, y and z. It lies on the floor. -->\n";
  return text + "<!--Pose: ,0 0 0.026,0 0 0,-->\n";
}

constexpr std::size_t most_hills = 50;

struct Options {
  std::string heights = "32,43,-43,43";
  std::string length = "400";
  std::string start = "360";
  std::string width = "2000";
  std::string segments = "10";
  std::string friction = "0.6";
  std::string floor_friction = "0.1";
  std::string out = "obstacle";
};

struct Range {
  double least;
  double most;
};

double parse(const char* option, std::string_view word, Range range) {
  const std::optional<double> number = parse_number(word);
  if (!number || !(*number >= range.least && *number <= range.most)) {
    throw InputError(option, 0, in_quotes(word),
                     "a number from " + number_text(range.least) + " to " + number_text(range.most));
  }
  return *number;
}

std::vector<double> parse_heights(const std::string& text) {
  std::vector<double> heights;
  std::size_t start = 0;
  while (start <= text.size()) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    heights.push_back(parse("--heights", text.substr(start, end - start), {-500, 500}));
    start = end + 1;
  }
  if (heights.size() > most_hills) {
    throw InputError("--heights", 0, std::to_string(heights.size()) + " hills",
                     "at most " + std::to_string(most_hills));
  }
  return heights;
}

Obstacle parse_obstacle(const Options& options) {
  Obstacle obstacle;
  obstacle.heights_mm = parse_heights(options.heights);
  obstacle.length_mm = parse("--length", options.length, {20, 5'000});
  obstacle.start_mm = parse("--start", options.start, {0, 5'000});
  obstacle.width_mm = parse("--width", options.width, {50, 16'000});
  const std::optional<unsigned> segments = parse_whole<unsigned>(options.segments);
  if (!segments || *segments < 2 || *segments > 100) {
    throw InputError("--segments", 0, in_quotes(options.segments), "a whole number from 2 to 100");
  }
  obstacle.segments = *segments;
  obstacle.friction = parse("--friction", options.friction, {0, 10});
  obstacle.floor_friction = parse("--floor-friction", options.floor_friction, {0, 10});
  return obstacle;
}

int write(const Options& options) {
  const std::array<sim::SourceFile, 1> files{
      sim::SourceFile{"obstacle.environment.xml", obstacle_text(parse_obstacle(options))}};
  write_new_files(options.out, files);
  std::cout << "use it:  <environment>" << options.out
            << "/obstacle.environment.xml</environment> in a top-level file\n";
  return exit_success;
}

}  // namespace

int new_obstacle(int argc, char** argv) {
  CommandLine command_line("proleg new obstacle",
                           "Writes an environment: a floor with hills and pits across the way of the robot. Without "
                           "options it is the obstacle of sim/scenarios/adaptive_touch.");
  Options options;
  command_line
      .add_option("--heights", options.heights,
                  "height of each hill in mm, first the one that the robot meets first; below 0: a pit")
      .value_name("MM,MM,...")
      .shows_default();
  command_line.add_option("--length", options.length, "length of each hill in mm, 20 to 5000")
      .value_name("MM")
      .shows_default();
  command_line.add_option("--start", options.start, "from the robot's position to the first hill in mm, 0 to 5000")
      .value_name("MM")
      .shows_default();
  command_line.add_option("--width", options.width, "of the hills in mm, 50 to 16000").value_name("MM").shows_default();
  command_line.add_option("--segments", options.segments, "flat pieces of each hill, 2 to 100")
      .value_name("N")
      .shows_default();
  command_line.add_option("--friction", options.friction, "coefficient of friction of the hills, 0 to 10")
      .value_name("X")
      .shows_default();
  command_line.add_option("--floor-friction", options.floor_friction, "that of the floor")
      .value_name("X")
      .shows_default();
  command_line.add_option("--out", options.out, "folder for the file, which must not exist")
      .value_name("FOLDER")
      .shows_default();
  return command_line.run(argc, argv, [&] { return write(options); });
}

}  // namespace proleg::tools
