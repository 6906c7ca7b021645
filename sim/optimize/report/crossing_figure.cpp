#include "sim/optimize/report/crossing_figure.hpp"

#include <algorithm>
#include <cmath>

#include "sim/record/outline.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {
namespace {

using sim::Point;
using sim::Polyline;
using sim::Svg;
using sim::TextAnchor;

/// View from the robot's right side: y to the right, z upwards.
const sim::View side_view{Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};

constexpr const char* obstacle_style = R"(fill="#b9a58c" stroke="#b9a58c" stroke-width="0.8" stroke-linejoin="round")";
constexpr const char* floor_style = R"(fill="#c9dcc3" stroke="none")";

/// A window on the world from the side, and where it is on the page.
struct Window {
  Point low;   ///< m
  Point high;  ///< m
  Point corner;
  double scale;  ///< pixels per m

  [[nodiscard]] Point pixel(Point p) const {
    return {corner.x + (p.x - low.x) * scale, corner.y + (high.y - p.y) * scale};
  }
  [[nodiscard]] double bottom() const { return corner.y + (high.y - low.y) * scale; }

  void draw(Svg& svg, const Polyline& polygon, std::string_view style) const {
    Polyline pixels;
    for (const Point& point : sim::clipped(polygon, low, high)) {
      pixels.push_back(pixel(point));
    }
    if (pixels.size() > 2) {
      svg.polygon(pixels, style);
    }
  }
};

void draw_world(Svg& svg, const sim::Scenario& scenario, const Window& window) {
  svg.begin_group("world");
  for (const bool obstacle : {false, true}) {
    for (const sim::StaticObject& object : scenario.environment.objects) {
      if ((object.name == "obstacle") == obstacle) {
        for (const sim::Geometry& solid : object.geometries) {
          window.draw(svg, sim::outline_of(solid, object.pose, side_view), obstacle ? obstacle_style : floor_style);
        }
      }
    }
  }
  svg.end_group();
}

void draw_robot(Svg& svg, const sim::Scenario& scenario, const CrossingStage& stage, const Window& window) {
  svg.begin_group("robot");
  for (std::size_t link = 0; link < stage.link_poses.size(); ++link) {
    const bool touches = link < stage.contacts.size() && stage.contacts[link] != 0;
    const char* style = touches ? R"(fill="#e69f00" stroke="#7a5200" stroke-width="1")"
                                : R"(fill="#8fb8d8" stroke="#1f4e79" stroke-width="1")";
    for (const sim::Geometry& solid : scenario.robot.links[link].geometries) {
      window.draw(svg, sim::outline_of(solid, stage.link_poses[link], side_view), style);
    }
  }
  svg.end_group();
}

/// The world around the obstacle, over the width of the page.
Window window_at(const ObstacleExtent& extent, double top, double low, double high) {
  const double from = extent.from - 0.4;
  const double to = std::max(extent.to + 0.4, from + 1.0);
  return {{from, low}, {to, high}, {sim::page_left, top}, (sim::page_right - sim::page_left) / (to - from)};
}

}  // namespace

ObstacleExtent obstacle_extent(const sim::EnvironmentModel& environment) {
  ObstacleExtent extent{INFINITY, -INFINITY};
  for (const sim::StaticObject& object : environment.objects) {
    if (object.name == "obstacle") {
      for (const sim::Geometry& solid : object.geometries) {
        for (const Point& point : sim::outline_of(solid, object.pose, side_view)) {
          extent = {std::min(extent.from, point.x), std::max(extent.to, point.x)};
        }
      }
    }
  }
  return extent.from < extent.to ? extent : ObstacleExtent{};
}

std::string draw_crossing(const sim::Scenario& scenario, std::span<const CrossingStage> stages) {
  constexpr double low = -0.08;
  constexpr double high = 0.24;
  constexpr double heading_room = 30.0;
  const ObstacleExtent extent = obstacle_extent(scenario.environment);
  const double height = window_at(extent, 0.0, low, high).bottom();
  const double page_height = sim::first_panel_top + static_cast<double>(stages.size()) * (height + heading_room) + 10.0;
  Svg svg(sim::page_width, page_height, "Stages of the crossing", "The robot on the obstacle, from the side.");
  sim::draw_title(svg, "Stages of the crossing", "links that touch the ground are orange; the head is on the right");
  double top = sim::first_panel_top;
  char letter = 'a';
  for (const CrossingStage& stage : stages) {
    sim::draw_heading(
        svg, top,
        "(" + std::string(1, letter++) + ") " + stage.name + ", after " + sim::plain_number(stage.time_s, 1) + " s");
    const Window window = window_at(extent, top, low, high);
    draw_world(svg, scenario, window);
    draw_robot(svg, scenario, stage, window);
    svg.rectangle(window.corner, sim::page_right - sim::page_left, height, sim::frame_style);
    top += height + heading_room;
  }
  return svg.finish();
}

std::string draw_distances(const sim::Scenario& scenario, std::span<const RulerMark> marks) {
  double farthest = 1.0;
  for (const RulerMark& mark : marks) {
    farthest = std::max(farthest, mark.distance_m);
  }
  farthest = std::min(std::ceil(farthest + 0.25), 1000.0);
  const double start = scenario.environment.robot_pose.position.y();
  const double from = start - 0.2;
  const double scale = (sim::page_right - sim::page_left) / (farthest + 0.2);
  constexpr double row_height = 26.0;
  constexpr double ruler_height = 14.0;
  const double rows_height = row_height * static_cast<double>(marks.size());
  const double world_top = sim::first_panel_top + rows_height;
  const Window window{{from, -0.08}, {from + farthest + 0.2, 0.1}, {sim::page_left, world_top}, scale};
  const double ruler_top = window.bottom() + 6.0;
  Svg svg(sim::page_width, ruler_top + ruler_height + 40.0, "Distances", "How far each gait went, on a ruler.");
  sim::draw_title(svg, "Distances on the obstacle", "each segment of the ruler is 1 m, from the start of the robot");
  draw_world(svg, scenario, window);
  std::vector<RulerMark> sorted(marks.begin(), marks.end());
  std::ranges::stable_sort(sorted, std::ranges::greater{}, &RulerMark::distance_m);
  const double zero = window.pixel({start, 0.0}).x;
  for (int metre = 0; metre < static_cast<int>(farthest); ++metre) {
    // The colours go from yellow to red, as in the thesis's scale.
    const int green = 220 - static_cast<int>(200.0 * metre / farthest);
    svg.rectangle({zero + metre * scale, ruler_top}, scale, ruler_height,
                  "fill=\"rgb(235," + std::to_string(green) + ",40)\" stroke=\"#777777\"");
    svg.text({zero + metre * scale, ruler_top + ruler_height + 16.0}, std::to_string(metre), TextAnchor::middle,
             sim::label_size, sim::ink);
  }
  svg.text({zero + farthest * scale, ruler_top + ruler_height + 16.0}, sim::plain_number(farthest, 0) + " m",
           TextAnchor::middle, sim::label_size, sim::ink);
  double y = sim::first_panel_top + row_height / 2.0;
  std::size_t number = 0;
  for (const RulerMark& mark : sorted) {
    const double x = zero + std::max(mark.distance_m, 0.0) * scale;
    const std::string colour = sim::distinct_colours[number++ % sim::distinct_colours.size()];
    svg.begin_group("mark");
    svg.line({zero, y}, {x, y}, "stroke=\"" + colour + "\" stroke-width=\"3\"");
    svg.line({x, y - 5.0}, {x, ruler_top}, "stroke=\"" + colour + "\" stroke-width=\"1\" stroke-dasharray=\"3 3\"");
    const std::string label = mark.name + " " + sim::plain_number(mark.distance_m, 2) + " m";
    svg.text({zero + 6.0, y - 5.0}, label, TextAnchor::start, sim::label_size, sim::ink);
    svg.end_group();
    y += row_height;
  }
  return svg.finish();
}

}  // namespace proleg::optimize
