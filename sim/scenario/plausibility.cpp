#include "sim/scenario/plausibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>

#include "shared/computer/text/text.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/geometry_reader.hpp"
#include "sim/scenario/surface_under.hpp"

namespace proleg::sim {
namespace {

std::string millimetres(double metres) { return number_text(std::round(metres * 1000.0)) + " mm"; }

std::string warning(const Origin& origin, const std::string& text) {
  return one_line(origin.file + ":" + std::to_string(origin.line) + ": " + text);
}

double length_of(const Bounds& bounds) { return (bounds.highest - bounds.lowest).maxCoeff(); }

/// The principal moments of inertia, ascending, and their axes.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal_moments(const MassProperties& mass) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(mass.inertia);
}

/// The solid box with this mass and inertia. What touches the ground is often only a part of a link; this is its size.
Geometry equivalent_box(const MassProperties& mass) {
  const auto principal = principal_moments(mass);
  const Eigen::Array3d moments = principal.eigenvalues().array();
  Eigen::Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) {
    axes.col(0) *= -1.0;
  }
  Geometry box;
  box.extents = (3.0 * (moments.sum() / 2.0 - moments) / mass.mass).max(0.0).sqrt().matrix();
  box.pose = {mass.center, Eigen::Quaterniond(axes)};
  return box;
}

/// The bounds of everything that a link is known to have, in the robot's frame.
Bounds bounds_of_link(const Link& link) {
  const Bounds box = bounds_of(equivalent_box(link.mass), link.pose);
  const std::optional<Bounds> geometries = bounds_of(link.geometries, link.pose);
  return geometries ? joined(*geometries, box) : box;
}

double distance(const Bounds& bounds, const Eigen::Vector3d& point) {
  return (bounds.lowest - point).cwiseMax(point - bounds.highest).cwiseMax(0.0).norm();
}

class RobotCheck {
 public:
  explicit RobotCheck(const Chain& chain) : chain_(&chain) {
    for (const Link& link : chain.links) {
      bounds_.push_back(bounds_of_link(link));
    }
  }

  std::vector<std::string> run() {
    for (std::size_t joint = 0; joint < chain_->joints.size(); ++joint) {
      check_distance(joint);
    }
    if (warnings_.empty()) {  // otherwise the positions of the joints are not known
      check_folds();
    }
    check_order_of_bodies();
    for (std::size_t link = 0; link < chain_->links.size(); ++link) {
      const std::size_t before = warnings_.size();
      check_mass(link);
      is_plausible_.push_back(warnings_.size() == before);
      check_place(link);
    }
    return std::move(warnings_);
  }

 private:
  void warn(const Origin& origin, const std::string& text) { warnings_.push_back(warning(origin, text)); }

  /// A joint is near both of its links. The tolerance is half a link, because a bracket may be no part of either. The
  /// axis of a joint in the frame of one of its links may be far from the shell of the other one, as in wrists: there
  /// the tolerance is many times the longest link, and a length in another unit is outside of it.
  void check_distance(std::size_t joint) {
    const auto excess = [&](std::size_t link) {
      return distance(bounds_[link], chain_->joints[joint].anchor) - length_of(bounds_[link]) / 2.0;
    };
    const std::size_t link = excess(joint) > excess(joint + 1) ? joint : joint + 1;
    const std::size_t nearer = link == joint ? joint + 1 : joint;
    constexpr double many = 10.0;
    const double tolerance =
        chain_->is_in_frame_of_link[joint] && excess(nearer) <= 0.0
            ? many * length_of(*std::ranges::max_element(bounds_, {}, length_of)) - length_of(bounds_[link]) / 2.0
            : 0.0;
    if (excess(link) > tolerance) {
      warn(chain_->joint_origins[joint], "joint " + in_quotes(chain_->joints[joint].name) + " is " +
                                             millimetres(distance(bounds_[link], chain_->joints[joint].anchor)) +
                                             " outside of its body " + in_quotes(chain_->links[link].name) +
                                             ", which is " + millimetres(length_of(bounds_[link])) +
                                             " long; usually <offsetfrom> is missing or names a wrong body, or the "
                                             "<translation> of the body is wrong");
    }
  }

  /// A joint whose bodies are in the opposite order turns the other way. That is meant if its axis is opposite too.
  void check_order_of_bodies() {
    const std::vector<bool>& headward_first = chain_->headward_first;
    const auto opposite = static_cast<std::size_t>(std::ranges::count(headward_first, true));
    const bool usual = opposite > headward_first.size() / 2;
    for (std::size_t joint = 0; joint < headward_first.size(); ++joint) {
      if (headward_first[joint] != usual && turns_against_others(joint)) {
        warn(chain_->joint_origins[joint],
             "joint " + in_quotes(chain_->joints[joint].name) +
                 " lists its two bodies in the opposite order of other joints, so that its angle has the opposite "
                 "sign; usually every joint lists the body towards the tail first");
      }
    }
  }

  [[nodiscard]] bool turns_against_others(std::size_t joint) const {
    constexpr double antiparallel = -0.99;
    for (std::size_t other = 0; other < chain_->joints.size(); ++other) {
      if (chain_->headward_first[other] != chain_->headward_first[joint] &&
          chain_->joints[other].axis.dot(chain_->joints[joint].axis) < antiparallel) {
        return true;
      }
    }
    return false;
  }

  void check_folds() {
    constexpr double back = -0.5;  // more than 120 degrees
    for (std::size_t joint = 1; joint + 1 < chain_->joints.size(); ++joint) {
      const Eigen::Vector3d before = chain_->joints[joint - 1].anchor - chain_->joints[joint].anchor;
      const Eigen::Vector3d after = chain_->joints[joint].anchor - chain_->joints[joint + 1].anchor;
      if (before.dot(after) < back * before.norm() * after.norm()) {
        warn(chain_->joint_origins[joint], "the chain folds back at joint " + in_quotes(chain_->joints[joint].name) +
                                               "; usually a body is turned by 180 degrees");
      }
    }
  }

  /// Two links of about the same size at about the same place. Nothing is known of the place of a link whose size or
  /// density is not plausible, because one of its lengths is wrong.
  void check_place(std::size_t link) {
    constexpr double share = 0.1;
    const Bounds& here = bounds_[link];
    for (std::size_t other = 0; other < link && is_plausible_[link]; ++other) {
      if (!is_plausible_[other]) {
        continue;
      }
      const Bounds& there = bounds_[other];
      const double tolerance = share * std::min(length_of(here), length_of(there));
      if ((here.lowest - there.lowest).norm() < tolerance && (here.highest - there.highest).norm() < tolerance) {
        warn(chain_->link_origins[link], "body " + in_quotes(chain_->links[link].name) + " is at the same place as " +
                                             in_quotes(chain_->links[other].name) +
                                             "; usually the <translation> of one of them is missing");
        return;
      }
    }
  }

  void check_mass(std::size_t link) {
    if (!has_possible_inertia(link)) {
      warn(chain_->link_origins[link],
           body_name(link) +
               " has an inertia that no solid has: one principal moment is larger than the sum of the two others; "
               "usually a number in <inertia> is wrong");
    } else if (const auto geometries = bounds_of(chain_->links[link].geometries, {})) {
      if (check_size(link, *geometries)) {
        check_density(link);
      }
    }
  }

  [[nodiscard]] bool has_possible_inertia(std::size_t link) const {
    const Eigen::Array3d moments = principal_moments(chain_->links[link].mass).eigenvalues().array();
    constexpr double rounding = 1e-6;
    return moments[2] <= (moments[0] + moments[1]) * (1.0 + rounding);
  }

  /// Whether mass and geometries are of one size.
  bool check_size(std::size_t link, const Bounds& geometries) {
    constexpr double max_ratio = 10.0;
    const double box = 2.0 * equivalent_box(chain_->links[link].mass).extents.maxCoeff();
    const double ratio = box / length_of(geometries);
    const bool is_one_size = ratio <= max_ratio && ratio >= 1.0 / max_ratio;
    if (!is_one_size) {
      warn(chain_->link_origins[link], body_name(link) + " has the inertia of a solid box of " + millimetres(box) +
                                           ", and its geometries have " + millimetres(length_of(geometries)) +
                                           "; usually <inertia> is not in kg m^2, or <extents> or another length of "
                                           "<Mass> or <Geom> is not in metres");
    }
    return is_one_size;
  }

  /// To be called only for a link with geometries. Without them its bounds may be a thin rod, which has no volume.
  void check_density(std::size_t link) {
    constexpr double min_density = 1.0;       // air
    constexpr double max_density = 25'000.0;  // above every metal
    const double mass = chain_->links[link].mass.mass;
    const double density = mass / (bounds_[link].highest - bounds_[link].lowest).prod();
    if (density < min_density || density > max_density) {
      warn(chain_->link_origins[link],
           body_name(link) + " has " + number_text(mass) + " kg, which is " + number_text(std::round(density)) +
               " kg/m^3; usually <total> is not in kilograms, or a length is not in metres");
    }
  }

  [[nodiscard]] std::string body_name(std::size_t link) const { return "body " + in_quotes(chain_->links[link].name); }

  const Chain* chain_;
  std::vector<Bounds> bounds_;      ///< of the links
  std::vector<bool> is_plausible_;  ///< mass and size of the links checked so far
  std::vector<std::string> warnings_;
};

/// The shortest way out of each other along the three axes of `left`; negative if they are apart along one of them.
/// Poses are those of the bodies in the world.
double depth_along_axes(const Geometry& left, const Pose& left_body, const Geometry& right, const Pose& right_body) {
  const Pose to_left = (left_body * left.pose).inverse();
  const Bounds here = bounds_of(left, to_left * left_body);
  const Bounds there = bounds_of(right, to_left * right_body);
  return (here.highest - there.lowest).cwiseMin(there.highest - here.lowest).minCoeff();
}

/// How far a sphere is in another geometry, whose bounds along its own axes count unless it is a sphere.
double depth_of_sphere(const Geometry& sphere, const Pose& sphere_body, const Geometry& other, const Pose& other_body) {
  const Pose to_other = (other_body * other.pose).inverse();
  const Eigen::Vector3d center = to_other * (sphere_body * sphere.pose.position);
  if (other.shape == Shape::sphere) {
    return sphere.extents.x() + other.extents.x() - center.norm();
  }
  const Bounds bounds = bounds_of(other, to_other * other_body);
  const Eigen::Vector3d outside = (bounds.lowest - center).cwiseMax(center - bounds.highest);
  const double distance = outside.maxCoeff() > 0.0 ? outside.cwiseMax(0.0).norm() : outside.maxCoeff();
  return sphere.extents.x() - distance;
}

/// The point of a solid that is farthest in a direction. Cylinders lie along y.
Eigen::Vector3d farthest(const Geometry& solid, const Pose& body, const Eigen::Vector3d& direction) {
  const Pose pose = body * solid.pose;
  const Eigen::Vector3d inner = pose.orientation.conjugate() * direction;
  const Eigen::Vector3d& extents = solid.extents;
  const Eigen::Vector3d signs = inner.unaryExpr([](double part) { return part < 0.0 ? -1.0 : 1.0; });
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  switch (solid.shape) {
    case Shape::box:
      point = signs.cwiseProduct(extents);
      break;
    case Shape::sphere:
      point = extents.x() * inner.normalized();
      break;
    case Shape::cylinder: {
      const Eigen::Vector3d across(inner.x(), 0.0, inner.z());
      point = across.norm() > 0.0 ? (extents.x() * across.normalized()).eval() : point;
      point.y() = signs.y() * extents.y();
      break;
    }
    case Shape::hull:
    case Shape::surface:
    case Shape::height_field:
      point = *std::ranges::max_element(solid.mesh->vertices, {},
                                        [&](const Eigen::Vector3d& vertex) { return vertex.dot(inner); });
      break;
  }
  return pose * point;
}

/// Whether two solids overlap by more than a tenth of their size. Steps towards the point of the differences of their
/// points that is nearest to 0 (Frank and Wolfe 1956) end at a plane between them if there is one.
bool overlap_much(const Geometry& left, const Pose& left_body, const Geometry& right, const Pose& right_body) {
  static constexpr double share = 0.9;
  constexpr int steps = 100;
  const auto centre = [](const Geometry& solid, const Pose& body) {
    const Bounds bounds = bounds_of(solid, body);
    return Eigen::Vector3d((bounds.lowest + bounds.highest) / 2.0);
  };
  const Eigen::Vector3d left_centre = centre(left, left_body);
  const Eigen::Vector3d right_centre = centre(right, right_body);
  const auto smaller = [](const Eigen::Vector3d& point, const Eigen::Vector3d& about) {
    return Eigen::Vector3d(about + share * (point - about));
  };
  Eigen::Vector3d nearest = left_centre - right_centre;
  for (int step = 0; step < steps && nearest.squaredNorm() > 0.0; ++step) {
    const Eigen::Vector3d corner = smaller(farthest(left, left_body, -nearest), left_centre) -
                                   smaller(farthest(right, right_body, nearest), right_centre);
    if (corner.dot(nearest) > 0.0) {
      return false;
    }
    const Eigen::Vector3d way = corner - nearest;
    nearest += std::min(1.0, -nearest.dot(way) / way.squaredNorm()) * way;
  }
  return true;
}

/// The value that the share of the values is below.
double quantile(std::vector<double> values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, place);
  return *place;
}

/// The slope between half of the neighbours in the rows and columns of the grid is below this.
double median_slope(const HeightField& field) {
  const double along_x = 2.0 * field.half_x / static_cast<double>(field.columns - 1);
  const double along_y = 2.0 * field.half_y / static_cast<double>(field.rows - 1);
  std::vector<double> slopes;
  for (std::size_t i = 0; i < field.heights.size(); ++i) {
    if ((i + 1) % field.columns != 0) {
      slopes.push_back(std::abs(field.heights[i + 1] - field.heights[i]) / along_x);
    }
    if (i + field.columns < field.heights.size()) {
      slopes.push_back(std::abs(field.heights[i + field.columns] - field.heights[i]) / along_y);
    }
  }
  return quantile(std::move(slopes), 0.5);
}

/// How far from the median a height may be. Most heights are within a range; 0 is that of a plane with obstacles.
double usual_distance(const HeightField& field) {
  constexpr double few = 0.05;
  constexpr double ranges = 20.0;
  const double side = 2.0 * std::max(field.half_x, field.half_y);
  const double range = quantile(field.heights, 1.0 - few) - quantile(field.heights, few);
  return range > 0.0 ? std::clamp(ranges * range, side / 10.0, side / 2.0) : side / 2.0;
}

}  // namespace

std::vector<std::string> check_robot(const Chain& chain) { return RobotCheck(chain).run(); }

std::vector<std::string> check_overlaps(const Chain& chain) {
  std::vector<std::string> pairs;
  const Origin* first = nullptr;
  for (std::size_t a = 0; a < chain.links.size(); ++a) {
    const Link& here = chain.links[a];
    for (std::size_t b = a + 2; b < chain.links.size(); ++b) {
      const Link& there = chain.links[b];
      const bool overlap = std::ranges::any_of(here.geometries, [&](const Geometry& left) {
        return std::ranges::any_of(there.geometries, [&](const Geometry& right) {
          return overlap_depth(left, here.pose, right, there.pose) > largest_start_depth &&
                 overlap_much(left, here.pose, right, there.pose);
        });
      });
      if (overlap) {
        first = first == nullptr ? &chain.link_origins[a] : first;
        pairs.push_back(in_quotes(here.name) + " and " + in_quotes(there.name));
      }
    }
  }
  if (pairs.empty()) {
    return {};
  }
  return {warning(*first,
                  "bodies overlap at the start that are no neighbours, and their contact may throw the robot "
                  "away: " +
                      listed(pairs) +
                      "; make what touches smaller, or write <selfcollision>0</selfcollision> into the "
                      "environment")};
}

std::vector<std::string> check_gravity(const Eigen::Vector3d& gravity, const Origin& origin) {
  const double noticeable = 0.5 * gravity.norm();  // at 60 degrees, steeper than any slope that can be crawled
  if (-gravity.z() > noticeable) {
    return {};
  }
  const std::string where = gravity.isZero()           ? "is 0, so that nothing holds the robot on the ground"
                            : gravity.z() > noticeable ? "points upwards"
                                                       : "points to the side";
  return {warning(origin, "gravity " + where + "; usually it is 0 0 -9.81")};
}

std::vector<std::string> check_heights(const HeightField& field, const Origin& origin) {
  constexpr double max_slope = 5.0;  // 79 degrees
  if (const double slope = median_slope(field); slope > max_slope) {
    return {warning(origin, "heights whose neighbours differ by " + number_text(slope) +
                                " times their distance, in the median; usually they are not in metres, or <extents> "
                                "is wrong")};
  }
  const double median = quantile(field.heights, 0.5);
  const double most = usual_distance(field);
  const auto is_far = [&](double height) { return std::abs(height - median) > most; };
  const auto first = std::ranges::find_if(field.heights, is_far);
  if (first == field.heights.end()) {
    return {};
  }
  const auto place = static_cast<std::size_t>(first - field.heights.begin());
  const auto others = std::ranges::count_if(first + 1, field.heights.end(), is_far);
  return {warning(origin, "the height " + number_text(*first) + " m in row " +
                              std::to_string(place / field.columns + 1) + ", column " +
                              std::to_string(place % field.columns + 1) +
                              (others > 0 ? " (the first of " + std::to_string(others + 1) + ")" : "") +
                              " is far from the median, " + number_text(median) +
                              " m; usually such a number says that no height is known, or is not in metres")};
}

double overlap_depth(const Geometry& left, const Pose& left_body, const Geometry& right, const Pose& right_body) {
  if (right.shape == Shape::surface || right.shape == Shape::height_field) {
    const Bounds here = bounds_of(left, left_body);
    const std::optional<double> top =
        highest_over(*right.mesh, right_body * right.pose, here.lowest.head<2>(), here.highest.head<2>());
    return top.value_or(here.lowest.z()) - here.lowest.z();
  }
  if (left.shape == Shape::sphere) {
    return depth_of_sphere(left, left_body, right, right_body);
  }
  if (right.shape == Shape::sphere) {
    return depth_of_sphere(right, right_body, left, left_body);
  }
  return std::min(depth_along_axes(left, left_body, right, right_body),
                  depth_along_axes(right, right_body, left, left_body));
}

double overlap_depth(const std::vector<Geometry>& left, const Pose& left_body, const Geometry& right,
                     const Pose& right_body) {
  double deepest = 0.0;
  for (const Geometry& geometry : left) {
    deepest = std::max(deepest, overlap_depth(geometry, left_body, right, right_body));
  }
  return deepest;
}

std::vector<std::string> check_start(const std::vector<Link>& links, const EnvironmentModel& environment,
                                     const std::string& environment_file) {
  std::vector<std::string> warnings;
  for (const Link& link : links) {
    const Pose link_pose = environment.robot_pose * link.pose;
    double deepest = largest_start_depth;
    const StaticObject* obstacle = nullptr;
    for (const StaticObject& object : environment.objects) {
      for (const Geometry& solid : object.geometries) {
        if (const double in = overlap_depth(link.geometries, link_pose, solid, object.pose); in > deepest) {
          deepest = in;
          obstacle = &object;
        }
      }
    }
    if (obstacle != nullptr) {
      warnings.push_back(one_line(environment_file + ": body " + in_quotes(link.name) + " starts " +
                                  millimetres(deepest) + " inside " + in_quotes(obstacle->name) +
                                  "; usually the start position is wrong"));
    }
  }
  std::vector<const StaticObject*> known;
  for (const Link& link : links) {
    const std::optional<Bounds> bounds = bounds_of(link.geometries, environment.robot_pose * link.pose);
    const std::optional<Surface> ground =
        bounds ? surface_under((bounds->lowest + bounds->highest) / 2.0, environment) : std::nullopt;
    if (ground && !ground->faces_up && std::ranges::find(known, ground->object) == known.end()) {
      known.push_back(ground->object);
      warnings.push_back(one_line(environment_file + ": the triangles of " + in_quotes(ground->object->name) +
                                  " face downwards under body " + in_quotes(link.name) +
                                  ", and touch only from below; usually the mesh must be turned inside out"));
    }
  }
  return warnings;
}

}  // namespace proleg::sim
