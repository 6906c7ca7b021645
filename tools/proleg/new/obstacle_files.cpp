#include "tools/proleg/new/obstacle_files.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

constexpr double thickness_mm = 20.0;

struct Point {
  double along;  ///< mm along the way of the robot
  double up;     ///< mm above the floor
};

/// Of the surface, from the first point of the first hill to the last point of the last one.
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

/// Metres, to the micrometre.
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

}  // namespace

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

}  // namespace proleg::tools
