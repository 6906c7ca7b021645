#include "sim/record/figure_panels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/measure/stride.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {
namespace {

constexpr double gap = 8.0;          // pixels between cells
constexpr double label_room = 18.0;  // pixels below a cell
constexpr double max_cell_height = 130.0;
constexpr double margin = 0.06;  // of the robot's length, around it

double tick_of(double time_s, const FigureContents& contents) { return time_s / contents.tick_s - 1.0; }

/// Begin and end, in s.
std::pair<double, double> last_stride(const FigureContents& contents) {
  std::vector<double> targets;
  const std::size_t ticks = contents.setpoints.front().size();
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    for (const Polyline& joint : contents.setpoints) {
      targets.push_back(joint[tick].y * std::numbers::pi / 180.0);
    }
  }
  const double first_s = contents.setpoints.front().front().x;
  if (const auto stride = find_stride({targets, contents.setpoints.size()}, contents.tick_s)) {
    const std::size_t last = stride->bounds.size() - 1;
    return {first_s + stride->bounds[last - 1] * contents.tick_s, first_s + stride->bounds[last] * contents.tick_s};
  }
  return {std::max(contents.to_s - 1.0, first_s), contents.to_s};
}

/// The poses at SYNC k + 1 are in row k of the recording, the contacts at that SYNC in row k + 1.
std::vector<Snapshot> take_snapshots(const Recording& recording, const FigureContents& contents, std::size_t count) {
  const auto [from_s, to_s] = last_stride(contents);
  std::vector<Snapshot> snapshots;
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = from_s + (to_s - from_s) * static_cast<double>(i) / static_cast<double>(count);
    const auto tick = static_cast<std::uint32_t>(
        std::clamp(std::round(tick_of(time_s, contents)), 1.0 * contents.first_tick, 1.0 * contents.last_tick));
    const std::uint32_t next = std::min(tick + 1, recording.last_tick());
    Snapshot snapshot{recording.time_s(tick), {}, {}, {}};
    recording.read_ticks(tick, next, [&](const RecordedTick& row) {
      if (row.tick == tick) {
        snapshot.link_poses = row.link_poses;
        snapshot.object_poses = row.object_poses;
      }
      snapshot.contacts = row.latched_contacts;
    });
    snapshots.push_back(std::move(snapshot));
  }
  return snapshots;
}

Eigen::Vector3d center_of(const std::vector<Pose>& poses) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Pose& pose : poses) {
    sum += pose.position;
  }
  return sum / static_cast<double>(poses.size());
}

/// The horizontal direction from tail to head; along x if the robot stands upright.
Eigen::Vector3d body_direction(const std::vector<Snapshot>& snapshots) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Snapshot& snapshot : snapshots) {
    sum += snapshot.link_poses.front().position - snapshot.link_poses.back().position;
  }
  sum.z() = 0.0;
  return sum.norm() > 1e-6 ? sum.normalized().eval() : Eigen::Vector3d::UnitX().eval();
}

bool goes_sideways(const std::vector<Snapshot>& snapshots, const Eigen::Vector3d& forward) {
  Eigen::Vector3d way = center_of(snapshots.back().link_poses) - center_of(snapshots.front().link_poses);
  way.z() = 0.0;
  constexpr double min_way = 0.005;  // m
  constexpr double cosine_of_30_degrees = 0.866;
  return way.norm() > min_way && std::abs(way.normalized().dot(forward)) < cosine_of_30_degrees;
}

struct Extent {
  Point low{INFINITY, INFINITY};
  Point high{-INFINITY, -INFINITY};
  void include(const Polyline& points, Point shift) {
    for (const Point& point : points) {
      low = {std::min(low.x, point.x - shift.x), std::min(low.y, point.y - shift.y)};
      high = {std::max(high.x, point.x - shift.x), std::max(high.y, point.y - shift.y)};
    }
  }
};

/// Where the middle of a cell is in its view, in m. Cells move with the robot, but not up and down.
Point middle_of(const RobotView& view, const Snapshot& snapshot) {
  const Point center = view.view.of(center_of(snapshot.link_poses));
  return {center.x, view.from_above ? center.y : view.center_y};
}

/// The extent of all snapshots, relative to the robot's centre; upright seen from the side.
Extent extent_of(const Scenario& scenario, const std::vector<Snapshot>& snapshots, const View& view, bool from_above) {
  Extent extent;
  for (const Snapshot& snapshot : snapshots) {
    const Point center = view.of(center_of(snapshot.link_poses));
    for (std::size_t link = 0; link < snapshot.link_poses.size(); ++link) {
      const Point shift{center.x, from_above ? center.y : 0.0};
      for (const Geometry& solid : scenario.robot.links[link].geometries) {
        extent.include(outline_of(solid, snapshot.link_poses[link], view), shift);
      }
      extent.include({view.of(snapshot.link_poses[link].position)}, shift);
    }
  }
  return extent;
}

RobotView make_view(const Scenario& scenario, const std::vector<Snapshot>& snapshots, const View& view, bool from_above,
                    double top) {
  const Extent extent = extent_of(scenario, snapshots, view, from_above);
  const double length = extent.high.x - extent.low.x;
  RobotView result{
      from_above ? "A stride from above" : "A stride from the side",
      view,
      from_above,
      0.0,
      // The centre of the links need not be the middle of the extent.
      {std::max(extent.high.x, -extent.low.x) + margin * length,
       (from_above ? std::max(extent.high.y, -extent.low.y) : (extent.high.y - extent.low.y) / 2.0) + margin * length},
      (extent.high.y + extent.low.y) / 2.0,
      snapshots.size() > 6 ? std::size_t{4} : std::size_t{2},
      top,
      0.0};
  const auto columns = static_cast<double>(result.columns);
  const double cell_width = (page_right - page_left - (columns - 1.0) * gap) / columns;
  result.pixels_per_m = std::min(cell_width / (2.0 * result.half_size.x), max_cell_height / (2.0 * result.half_size.y));
  result.half_size.x = cell_width / 2.0 / result.pixels_per_m;
  const auto rows = std::ceil(static_cast<double>(snapshots.size()) / columns);
  result.height = rows * (2.0 * result.half_size.y * result.pixels_per_m + label_room);
  return result;
}

/// A cell: what part of the view it shows, and where it is on the page.
struct Cell {
  Point low;     ///< m
  Point high;    ///< m
  Point corner;  ///< upper left, pixels
  double scale;  ///< pixels per m

  [[nodiscard]] Point pixel(Point p) const {
    return {corner.x + (p.x - low.x) * scale, corner.y + (high.y - p.y) * scale};
  }
  [[nodiscard]] Polyline pixels(const Polyline& polygon) const {
    Polyline result;
    for (const Point& point : clipped(polygon, low, high)) {
      result.push_back(pixel(point));
    }
    return result;
  }
};

Cell cell_of(const RobotView& view, const Snapshot& snapshot, std::size_t number) {
  const Point middle = middle_of(view, snapshot);
  const double width = 2.0 * view.half_size.x * view.pixels_per_m;
  const double height = 2.0 * view.half_size.y * view.pixels_per_m;
  const std::size_t rows_before = number / view.columns;
  const auto column = static_cast<double>(number - rows_before * view.columns);
  const auto row = static_cast<double>(rows_before);
  return {{middle.x - view.half_size.x, middle.y - view.half_size.y},
          {middle.x + view.half_size.x, middle.y + view.half_size.y},
          {page_left + column * (width + gap), view.top + row * (height + label_room)},
          view.pixels_per_m};
}

void draw_polygon(Svg& svg, const Polyline& polygon, std::string_view style) {
  if (polygon.size() > 2) {
    svg.polygon(polygon, style);
  }
}

/// Distance of the marks on the ground, in m: 50 mm, or more if they would be too close together on the page.
double mark_spacing(const RobotView& view) {
  constexpr double spacing = 0.05;
  constexpr double min_pixels = 12.0;
  return spacing * std::max(1.0, std::ceil(min_pixels / (spacing * view.pixels_per_m)));
}

/// Marks on the ground, so that the motion can be seen: along the lower edge, or as dots from above.
void draw_scale(Svg& svg, const RobotView& view, const Cell& cell) {
  const double step = mark_spacing(view);
  Polyline places;
  for (double x = std::ceil(cell.low.x / step) * step; x < cell.high.x; x += step) {
    if (!view.from_above) {
      places.push_back(cell.pixel({x, cell.low.y}));
    }
    for (double y = std::ceil(cell.low.y / step) * step; view.from_above && y < cell.high.y; y += step) {
      places.push_back(cell.pixel({x, y}));
    }
  }
  svg.marks(places, view.from_above ? "h0" : "v-4", R"(stroke="#9a8f78" stroke-width="1.4" stroke-linecap="round")");
}

/// The touch sensors that are pressed, in the middle of the half of the link that each senses.
void draw_contacts(Svg& svg, const Scenario& scenario, const RobotView& view, const Snapshot& snapshot,
                   const Cell& cell) {
  for (std::size_t link = 0; link < snapshot.contacts.size(); ++link) {
    const Link& model = scenario.robot.links[link];
    const LinkEnds ends = link_ends(scenario.robot, link);
    const Eigen::Vector3d quarter = model.pose.orientation.conjugate() * ((ends.front - ends.rear) / 4.0);
    double bottom = view.view.of(snapshot.link_poses[link] * model.mass.center).y;
    for (const Geometry& solid : model.geometries) {
      const Polyline outline = outline_of(solid, snapshot.link_poses[link], view.view);
      bottom = std::min(bottom, std::ranges::min(outline, {}, &Point::y).y);
    }
    for (const unsigned sensor : {0U, 1U}) {
      if (((snapshot.contacts[link] >> sensor) & 1U) == 0) {
        continue;
      }
      const Eigen::Vector3d in_link = model.mass.center + (sensor == 0 ? -1.0 : 1.0) * quarter;
      const Point place = view.view.of(snapshot.link_poses[link] * in_link);
      svg.circle(cell.pixel({place.x, view.from_above ? place.y : bottom}), 2.6, R"(class="touch" fill="#d55e00")");
    }
  }
}

void draw_robot(Svg& svg, const Scenario& scenario, const RobotView& view, const Snapshot& snapshot, const Cell& cell) {
  for (std::size_t link = 0; link < snapshot.link_poses.size(); ++link) {
    const Link& model = scenario.robot.links[link];
    const Pose& pose = snapshot.link_poses[link];
    // The line of a link goes from joint to joint, since the shapes that touch may be smaller than the link.
    const Pose to_link{model.pose.orientation.conjugate() * -model.pose.position, model.pose.orientation.conjugate()};
    const LinkEnds ends = link_ends(scenario.robot, link);
    const Point rear = cell.pixel(view.view.of(pose * (to_link * ends.rear)));
    const Point front = cell.pixel(view.view.of(pose * (to_link * ends.front)));
    svg.line(rear, front, R"(stroke="#0072b2" stroke-width="2.4" stroke-linecap="round")");
    for (const Geometry& solid : model.geometries) {
      draw_polygon(svg, cell.pixels(outline_of(solid, pose, view.view)),
                   link == 0 ? R"(class="link" fill="#0072b2" fill-opacity="0.55" stroke="#004c77" stroke-width="1")"
                             : R"(class="link" fill="#0072b2" fill-opacity="0.2" stroke="#004c77" stroke-width="1")");
    }
    for (const Look& look : model.looks) {
      Geometry shown;
      shown.shape = Shape::hull;
      shown.pose = look.pose;
      shown.mesh = look.mesh;
      draw_polygon(svg, cell.pixels(outline_of(shown, pose, view.view)),
                   R"(class="look" fill="none" stroke="#004c77" stroke-width="0.6" stroke-dasharray="2 2")");
    }
    if (link + 1 < snapshot.link_poses.size()) {
      svg.circle(rear, 2.2, R"(fill="#ffffff" stroke="#004c77" stroke-width="1")");
    }
  }
}

constexpr std::string_view terrain_from_above = R"(class="terrain" fill="#f3eee4" stroke="#cfc4ad" stroke-width="1")";
constexpr std::string_view terrain_from_side = R"(class="terrain" fill="#e9e1d0" stroke="#a89a7c" stroke-width="1")";

/// A mesh may be concave: seen from the side it is cut near the robot.
void draw_surface(Svg& svg, const Geometry& solid, const Pose& pose, const RobotView& view, const Snapshot& snapshot,
                  const Cell& cell) {
  constexpr double half_thickness = 0.02;  // m
  const Eigen::Vector3d across = view.view.right.cross(view.view.up);
  MeshSection section(view.view, across.dot(center_of(snapshot.link_poses)), half_thickness, cell.low.x, cell.high.x);
  section.add(*solid.mesh, pose);
  for (Polyline polygon : section.polygons()) {
    for (Point& point : polygon) {
      point = cell.pixel({point.x, std::clamp(point.y, cell.low.y, cell.high.y)});
    }
    draw_polygon(svg, polygon, terrain_from_side);
  }
}

void draw_terrain(Svg& svg, const Scenario& scenario, const RobotView& view, const Snapshot& snapshot,
                  const Cell& cell) {
  for (const StaticObject& object : scenario.environment.objects) {
    for (const Geometry& solid : object.geometries) {
      if (solid.mesh && !view.from_above) {
        draw_surface(svg, solid, object.pose * solid.pose, view, snapshot, cell);
      } else {
        draw_polygon(svg, cell.pixels(outline_of(solid, object.pose, view.view)),
                     view.from_above ? terrain_from_above : terrain_from_side);
      }
    }
  }
}

/// Segments whose colours alternate: areas from above, a line from the side.
void draw_rulers(Svg& svg, const Scenario& scenario, const RobotView& view, const Cell& cell) {
  for (const Ruler& ruler : scenario.environment.rulers) {
    const Eigen::Vector3d way = ruler.to - ruler.from;
    const Eigen::Vector3d along = way.normalized();
    const Eigen::Vector3d across = along.cross(Eigen::Vector3d::UnitZ()) * (ruler.width / 2.0);
    const double length = way.norm();
    bool is_red = false;
    for (double at = 0.0; at < length; at += ruler.division, is_red = !is_red) {
      const Eigen::Vector3d from = ruler.from + at * along;
      const Eigen::Vector3d to = ruler.from + std::min(at + ruler.division, length) * along;
      const double thickness = view.from_above ? 0.0 : 2.0 / cell.scale;
      const Eigen::Vector3d up = view.view.up * thickness;
      const Polyline polygon = view.from_above ? Polyline{view.view.of(from - across), view.view.of(from + across),
                                                          view.view.of(to + across), view.view.of(to - across)}
                                               : Polyline{view.view.of(from), view.view.of(to), view.view.of(to + up),
                                                          view.view.of(from + up)};
      draw_polygon(svg, cell.pixels(polygon),
                   is_red ? R"(class="ruler" fill="#d1495b")" : R"(class="ruler" fill="#edae49")");
    }
  }
}

void draw_objects(Svg& svg, const Scenario& scenario, const RobotView& view, const Snapshot& snapshot,
                  const Cell& cell) {
  const std::vector<MovingObject>& objects = scenario.environment.moving_objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Pose& pose = i < snapshot.object_poses.size() ? snapshot.object_poses[i] : objects[i].pose;
    for (const Geometry& solid : objects[i].geometries) {
      draw_polygon(svg, cell.pixels(outline_of(solid, pose, view.view)),
                   R"(class="object" fill="#009e73" fill-opacity="0.35" stroke="#00614a" stroke-width="1")");
    }
  }
}

bool is_whole(const Extent& extent, const Scenario& scenario) {
  double length = 0.0;
  for (std::size_t link = 0; link < scenario.robot.links.size(); ++link) {
    const LinkEnds ends = link_ends(scenario.robot, link);
    length += (ends.front - ends.rear).norm();
  }
  const double size = std::max(extent.high.x - extent.low.x, extent.high.y - extent.low.y);
  return size > 0.0 && size < 10.0 * length;
}

}  // namespace

RobotViews make_robot_views(const Recording& recording, const FigureContents& contents, const Scenario& scenario,
                            double top) {
  constexpr std::size_t long_chain = 8;  // links
  RobotViews result{{}, {}, top};
  std::vector<Snapshot> snapshots =
      take_snapshots(recording, contents, scenario.robot.links.size() <= long_chain ? 8 : 6);
  const Eigen::Vector3d forward = body_direction(snapshots);
  const View side{forward, Eigen::Vector3d::UnitZ()};
  if (!is_whole(extent_of(scenario, snapshots, side, false), scenario)) {
    return result;
  }
  const bool bends_sideways = std::ranges::any_of(
      scenario.robot.joints, [](const Joint& joint) { return direction_of(joint) == JointDirection::yaw; });
  const auto add = [&](const View& view, bool from_above) {
    result.views.push_back(make_view(scenario, snapshots, view, from_above, result.bottom));
    result.bottom += result.views.back().height + 40.0;
  };
  add(side, false);
  if (bends_sideways || goes_sideways(snapshots, forward)) {
    add({forward, Eigen::Vector3d::UnitZ().cross(forward)}, true);
  }
  result.snapshots = std::move(snapshots);
  return result;
}

void draw_robot_views(Svg& svg, const Scenario& scenario, const RobotViews& views) {
  for (const RobotView& view : views.views) {
    draw_heading(svg, view.top, view.heading);
    const std::string spacing = plain_number(1000.0 * mark_spacing(view), 0);
    svg.text({page_right, view.top - 12.0},
             "the head is dark; dots: pressed touch sensors; marks every " + spacing + " mm of ground", TextAnchor::end,
             label_size, faint_ink);
    for (std::size_t i = 0; i < views.snapshots.size(); ++i) {
      const Snapshot& snapshot = views.snapshots[i];
      const Cell cell = cell_of(view, snapshot, i);
      svg.begin_group("view");
      draw_terrain(svg, scenario, view, snapshot, cell);
      draw_rulers(svg, scenario, view, cell);
      draw_scale(svg, view, cell);
      draw_objects(svg, scenario, view, snapshot, cell);
      draw_robot(svg, scenario, view, snapshot, cell);
      draw_contacts(svg, scenario, view, snapshot, cell);
      const double width = (cell.high.x - cell.low.x) * cell.scale;
      const double height = (cell.high.y - cell.low.y) * cell.scale;
      svg.rectangle(cell.corner, width, height, R"(fill="none" stroke="#cccccc" stroke-width="1")");
      svg.text({cell.corner.x + width / 2.0, cell.corner.y + height + 13.0}, plain_number(snapshot.time_s, 2) + " s",
               TextAnchor::middle, 11.0, faint_ink);
      svg.end_group();
    }
  }
}

}  // namespace proleg::sim
