#include "tools/proleg/ui/scenario_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "sim/robot/bounds.hpp"
#include "tools/proleg/ui/ground_section.hpp"
#include "tools/proleg/ui/solid_sides.hpp"

namespace proleg::tools {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double width = 1000.0;
constexpr double height = 500.0;
constexpr double margin = 0.06;        // of the picture's width, beside what it shows
constexpr double ground_share = 0.08;  // of the height: the side of the ground that is seen
constexpr std::size_t sections = 4;    // of the ground, from the back to the front
constexpr std::size_t most_lines = 14;
constexpr std::size_t most_objects = 12;
constexpr std::size_t most_path_points = 40;
constexpr std::size_t most_links_with_sides = 12;  // longer robots are drawn with less detail
constexpr std::size_t most_links = 30;             // still longer ones as a thick line
constexpr std::size_t most_small_solids = 24;      // beside the largest one of each link
constexpr double light_steps = 4.0;

/// A range of a coordinate.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void grow(double by) {
    low -= by;
    high += by;
  }
  [[nodiscard]] double size() const { return high - low; }
  [[nodiscard]] double middle() const { return (low + high) / 2.0; }
  [[nodiscard]] bool has(double value) const { return value >= low && value <= high; }
};

/// A part of what the camera sees, in m.
struct Box {
  Range across;
  Range up;
  void include(const Vector2d& point) {
    across.include(point.x());
    up.include(point.y());
  }
  void include(std::span<const Vector3d> points, const Camera& camera) {
    for (const Vector3d& point : points) {
      include(camera.of(point));
    }
  }
  /// The width of a picture that shows it all.
  [[nodiscard]] double needed_width() const {
    return std::max(across.size(), up.size() * width / height) * (1.0 + 2.0 * margin);
  }
};

/// The ends of the links, from the head to the tail.
std::vector<Vector3d> spine_of(const sim::RobotModel& robot, std::span<const sim::Pose> links) {
  std::vector<Vector3d> points;
  for (std::size_t link = 0; link < links.size(); ++link) {
    const sim::Pose to_link = robot.links[link].pose.inverse();
    const sim::LinkEnds ends = sim::link_ends(robot, link);
    if (link == 0) {
      points.push_back(links[link] * (to_link * ends.front));
    }
    points.push_back(links[link] * (to_link * ends.rear));
  }
  return points;
}

/// The height of a link in the middle of the robot, in m.
double thickness_of(const sim::RobotModel& robot) {
  constexpr double usual = 0.04;
  const sim::Link& link = robot.links[robot.links.size() / 2];
  double thickness = 0.0;
  for (const sim::Geometry& geometry : link.geometries) {
    const sim::Bounds bounds = sim::bounds_of(geometry, link.pose);
    thickness = std::max(thickness, bounds.highest.z() - bounds.lowest.z());
  }
  return thickness > 0.0 ? thickness : usual;
}

double length_of(std::span<const Vector3d> line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    length += (line[i] - line[i - 1]).norm();
  }
  return length;
}

Vector3d middle_of(std::span<const Vector3d> points) {
  return std::accumulate(points.begin(), points.end(), Vector3d(Vector3d::Zero())) / static_cast<double>(points.size());
}

/// The step of the lines on the ground, in m: 1, 2 or 5 times a power of ten.
double line_step(double length) {
  const double least = length / static_cast<double>(most_lines);
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) {
      return factor * power;
    }
  }
  return 10.0 * power;
}

class Picture {
 public:
  Picture(const sim::Scenario& scenario, const GaitPreview& preview)
      : scenario_(scenario),
        preview_(preview),
        ground_(scenario.environment),
        thickness_(thickness_of(scenario.robot)),
        start_(spine_of(scenario.robot, preview.start)),
        camera_(0.0, 0.0) {
    for (const std::vector<sim::Pose>& moment : preview.moments) {
      spines_.push_back(spine_of(scenario.robot, moment));
    }
    floor_ = ground_.at(start_.front().head<2>()).value_or(lowest() - thickness_ / 2.0);
    look();
    frame();
  }

  [[nodiscard]] json document() const {
    json picture{{"view", is_from_above_ ? "above" : "side"},
                 {"step", step_},
                 {"thickness", std::lround(thickness_ * scale_)},
                 {"ground", json::array()},
                 {"lines", json::array()},
                 {"objects", json::array()},
                 {"path", path_json()},
                 {"ghosts", json::array()},
                 {"shadow", shadow_json()},
                 {"body", points_json(spines_.back())},
                 {"links", links_json()}};
    add_ground(picture);
    add_objects(picture["objects"]);
    for (std::size_t i = 0; i + 1 < spines_.size(); ++i) {
      picture["ghosts"].push_back(points_json(spines_[i]));
    }
    return picture;
  }

 private:
  [[nodiscard]] double lowest() const {
    return std::ranges::min(start_, {}, [](const Vector3d& point) { return point.z(); }).z();
  }

  /// Chooses the direction of the camera.
  void look() {
    Vector3d body = start_.front() - start_.back();
    body.z() = 0.0;
    const double length = length_of(start_);
    Vector3d way = middle_of(spines_.back()) - middle_of(start_);
    way.z() = 0.0;
    Vector3d right = body.norm() > 0.1 * length ? body.normalized().eval() : Vector3d(Vector3d::UnitY());
    constexpr double cosine_of_45_degrees = 0.7071;
    constexpr double turned = 0.5;  // rad: a body that goes sideways is seen at an angle
    if (way.norm() > 0.15 * length && std::abs(way.normalized().dot(right)) < cosine_of_45_degrees) {
      right = way.normalized();
      right = Eigen::AngleAxisd(turned * (right.cross(body).z() > 0.0 ? 1.0 : -1.0), Vector3d::UnitZ()) * right;
    }
    const double azimuth = std::atan2(right.y(), right.x());
    const Camera level(azimuth, 0.0);
    Range along;
    Range aside;
    for (const std::vector<Vector3d>& spine : spines_) {
      for (const Vector3d& point : spine) {
        along.include(level.right.dot(point));
        aside.include(level.away.dot(point));
      }
    }
    for (const Vector3d& point : preview_.path) {
      along.include(level.right.dot(point));
      aside.include(level.away.dot(point));
    }
    const double share = aside.size() / std::max(along.size(), thickness_);
    constexpr double little = 0.12;
    constexpr double much = 0.35;
    constexpr double degree = std::numbers::pi / 180.0;
    const double elevation = share < little ? 20.0 : share < much ? 38.0 : 55.0;
    is_from_above_ = share >= little;
    camera_ = Camera(azimuth, elevation * degree);
  }

  /// Chooses what part of the world the picture shows.
  void frame() {
    Box robot;
    for (const std::vector<Vector3d>& spine : spines_) {
      robot.include(spine, camera_);
    }
    robot.across.grow(thickness_);
    robot.up.grow(thickness_ / 2.0);
    if (is_from_above_) {
      robot.up.low -= ground_share * robot.needed_width() * height / width;
    }
    Box all = robot;
    for (const Vector3d& point : preview_.path) {
      all.include(camera_.of(on_ground(point)));
    }
    include_what_is_ahead(robot.across, all.across);
    for (const sim::Pose& pose : preview_.objects) {
      const Vector2d place = camera_.of(pose.position);
      Range near = robot.across;
      near.grow(0.6 * length_of(start_));
      if (near.has(place.x())) {
        all.include(place);
      }
    }
    // Of a long way only the end is shown, or the robot would be too small.
    const double most = is_from_above_ ? 1.4 : 1.8;
    size_ = std::clamp(all.needed_width(), robot.needed_width(), most * robot.needed_width());
    constexpr double aspect = height / width;
    left_ = begin_of(robot.across, all.across, size_);
    bottom_ = begin_of(robot.up, all.up, size_ * aspect);
    if (is_from_above_) {
      // The ground fills the picture.
      const double rise = camera_.up.dot(camera_.away);
      const double at_floor = bottom_ - camera_.up.z() * floor_;
      aside_ = {(at_floor + ground_share * size_ * aspect) / rise, (at_floor + size_ * aspect) / rise + thickness_};
    } else {
      frame_strip();
    }
    scale_ = width / size_;
    step_ = line_step(size_);
  }

  /// The ground is a strip under the robot.
  void frame_strip() {
    Range z;
    aside_ = {};
    const auto include = [&](const Vector3d& point) {
      if (Range{left_, left_ + size_}.has(camera_.right.dot(point))) {
        aside_.include(camera_.away.dot(point));
        z.include(point.z());
      }
    };
    for (const std::vector<Vector3d>& spine : spines_) {
      std::ranges::for_each(spine, include);
    }
    std::ranges::for_each(preview_.path, include);
    z.include(floor_);
    z.grow(thickness_ / 2.0);
    for (const sim::Pose& pose : preview_.objects) {
      if (std::abs(camera_.away.dot(pose.position) - aside_.middle()) < 0.25 * size_) {
        include(pose.position);
      }
    }
    aside_.grow(thickness_ / 2.0 + 0.08 * size_);
    Range up;
    up.include(camera_.up.dot(camera_.point(0.0, aside_.low, floor_)));
    up.include(camera_.up.dot(camera_.point(0.0, aside_.high, floor_)));
    up.include(camera_.up.dot(camera_.point(0.0, aside_.middle(), z.high)));
    constexpr int places = 20;
    for (int i = 0; i <= places; ++i) {  // hills and walls, unless they are high
      const Vector3d place = camera_.point(left_ + size_ * i / places, aside_.high, 0.0);
      const double top = ground_.at(place.head<2>()).value_or(floor_);
      up.include(
          camera_.up.dot(camera_.point(0.0, aside_.high, std::clamp(top, floor_ - size_ / 4.0, z.high + size_ / 5.0))));
    }
    const double middle = left_ + size_ / 2.0;
    const double aspect = height / width;
    size_ = std::max(size_, up.size() * (1.0 + 2.0 * margin + ground_share) / aspect);
    left_ = middle - size_ / 2.0;
    const double rest = size_ * aspect - up.size();
    bottom_ = up.low - std::min(rest / 2.0, 2.0 * ground_share * size_ * aspect);
  }

  /// Where a picture of this size begins: it shows `needed`, and of `all` as much as it can.
  [[nodiscard]] static double begin_of(const Range& needed, const Range& all, double size) {
    const double free = std::max(0.0, size - needed.size());
    const double beside = std::min(margin * size, free / 2.0);
    const double wanted = all.middle() - size / 2.0;
    return std::max(std::min(wanted, needed.low - beside), needed.high + beside - size);
  }

  /// An obstacle in front of the robot belongs into the picture.
  void include_what_is_ahead(const Range& robot, Range& along) const {
    const double length = length_of(start_);
    const double aside = camera_.away.dot(middle_of(spines_.back()));
    const auto height_at = [&](double place) {
      return ground_.at(camera_.point(place, aside, 0.0).head<2>()).value_or(floor_);
    };
    constexpr int steps = 40;
    for (int i = 1; i <= steps; ++i) {
      const double place = robot.high + 1.4 * length * i / steps;
      if (std::abs(height_at(place) - floor_) > 0.2 * thickness_) {
        along.include(place + 0.35 * length);
        return;
      }
    }
  }

  [[nodiscard]] long x_of(const Vector2d& point) const { return std::lround((point.x() - left_) * scale_); }
  [[nodiscard]] long y_of(const Vector2d& point) const { return std::lround(height - (point.y() - bottom_) * scale_); }
  void append(json& numbers, const Vector2d& point) const {
    numbers.push_back(x_of(point));
    numbers.push_back(y_of(point));
  }
  [[nodiscard]] json points_json(std::span<const Vector3d> points) const {
    json numbers = json::array();
    for (const Vector3d& point : points) {
      append(numbers, camera_.of(point));
    }
    return numbers;
  }

  [[nodiscard]] double aside_of_section(std::size_t section) const {
    return aside_.high - aside_.size() * static_cast<double>(section) / static_cast<double>(sections - 1);
  }

  void add_ground(json& picture) const {
    if (scenario_.environment.objects.empty()) {
      return;
    }
    constexpr std::size_t most_points = 36;
    const double missing = floor_ - size_ * height / width;  // below the picture
    for (std::size_t section = 0; section < sections; ++section) {
      const double aside = aside_of_section(section);
      const Vector2d from = camera_.point(left_, aside, 0.0).head<2>();
      double tolerance = 0.002 * size_;
      std::vector<SectionPoint> points;
      do {
        points = ground_section(ground_, from, camera_.right.head<2>(), size_, tolerance, missing);
        tolerance *= 2.0;
      } while (points.size() > most_points);
      json numbers = json::array();
      for (const SectionPoint& point : points) {
        append(numbers, camera_.of(camera_.point(left_ + point.x(), aside, point.y())));
      }
      picture["ground"].push_back(std::move(numbers));
    }
    for (double place = std::ceil(left_ / step_) * step_; place < left_ + size_; place += step_) {
      std::vector<SectionPoint> points = ground_section(ground_, camera_.point(place, aside_.low, 0.0).head<2>(),
                                                        camera_.away.head<2>(), aside_.size(), 0.004 * size_, missing);
      if (points.size() > 8) {
        continue;
      }
      json numbers = json::array();
      for (const SectionPoint& point : points) {
        append(numbers, camera_.of(camera_.point(place, aside_.low + point.x(), point.y())));
      }
      picture["lines"].push_back(std::move(numbers));
    }
  }

  void add_objects(json& objects) const {
    for (std::size_t i = 0; i < preview_.objects.size() && objects.size() < most_objects; ++i) {
      const sim::Pose& pose = preview_.objects[i];
      const bool is_seen = aside_.has(camera_.away.dot(pose.position)) &&
                           Range{left_, left_ + size_}.has(camera_.right.dot(pose.position));
      if (!is_seen) {
        continue;
      }
      for (const sim::Geometry& geometry : scenario_.environment.moving_objects[i].geometries) {
        for (const Side& side : sides_of(geometry, pose, camera_, false)) {
          objects.push_back(side_json(side));
        }
      }
    }
  }

  /// [light, x, y, x, y, ...]
  [[nodiscard]] json side_json(const Side& side) const {
    json numbers{std::lround(side.light * light_steps)};
    for (const Vector2d& corner : side.corners) {
      append(numbers, corner);
    }
    return numbers;
  }

  /// On the ground.
  [[nodiscard]] json path_json() const {
    const std::vector<Vector3d>& path = preview_.path;
    json numbers = json::array();
    const std::size_t stride = std::max<std::size_t>(1, (path.size() + most_path_points - 1) / most_path_points);
    for (std::size_t i = 0; i < path.size() && path.size() > 1; i += stride) {
      append(numbers, camera_.of(on_ground(path[i])));
    }
    return numbers;
  }
  [[nodiscard]] json shadow_json() const {
    json numbers = json::array();
    for (const Vector3d& point : spines_.back()) {
      append(numbers, camera_.of(on_ground(point)));
    }
    return numbers;
  }
  [[nodiscard]] Vector3d on_ground(Vector3d point) const {
    point.z() = std::min(ground_.at(point.head<2>()).value_or(floor_), point.z());
    return point;
  }

  /// From the farthest to the nearest.
  [[nodiscard]] std::vector<std::size_t> order_of_links() const {
    std::vector<std::size_t> order(preview_.moments.back().size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::vector<sim::Pose>& poses = preview_.moments.back();
    std::ranges::stable_sort(order, {}, [&](std::size_t link) { return camera_.toward.dot(poses[link].position); });
    return order;
  }

  /// [[0 or 1: the head, [side], ...], ...]
  [[nodiscard]] json links_json() const {
    json links = json::array();
    const std::vector<sim::Pose>& poses = preview_.moments.back();
    if (poses.size() > most_links) {
      return links;
    }
    std::size_t small_solids = 0;
    for (const std::size_t link : order_of_links()) {
      json sides{link == 0 ? 1 : 0};
      const std::vector<sim::Geometry>& geometries = scenario_.robot.links[link].geometries;
      const auto largest = std::ranges::max_element(
          geometries, {}, [](const sim::Geometry& geometry) { return geometry.extents.prod(); });
      for (auto geometry = geometries.begin(); geometry != geometries.end(); ++geometry) {
        if (geometry != largest && ++small_solids > most_small_solids) {
          continue;
        }
        const bool is_simple = geometry != largest || poses.size() > most_links_with_sides;
        for (const Side& side : sides_of(*geometry, poses[link], camera_, is_simple)) {
          sides.push_back(side_json(side));
        }
      }
      links.push_back(std::move(sides));
    }
    return links;
  }

  const sim::Scenario& scenario_;
  const GaitPreview& preview_;
  GroundHeights ground_;
  double thickness_;
  std::vector<Vector3d> start_;                ///< the ends of the links, from the head to the tail
  std::vector<std::vector<Vector3d>> spines_;  ///< the same at each moment
  double floor_ = 0.0;                         ///< m, under the head at the start
  Camera camera_;
  bool is_from_above_ = false;
  Range aside_;          ///< of the strip of ground, along camera_.away
  double left_ = 0.0;    ///< m, along camera_.right
  double bottom_ = 0.0;  ///< m, along camera_.up
  double size_ = 1.0;    ///< m, of the picture's width
  double scale_ = 1.0;   ///< numbers of the picture in a metre
  double step_ = 0.1;    ///< m, between two lines on the ground
};

}  // namespace

json picture_json(const sim::Scenario& scenario, const GaitPreview& preview) {
  return Picture(scenario, preview).document();
}

}  // namespace proleg::tools
