#include "sim/scenario/environment_reader.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/geometry_reader.hpp"
#include "sim/scenario/kinbody_reader.hpp"
#include "sim/scenario/plausibility.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr Range accelerations{-1e3, 1e3, "m/s^2"};
constexpr double max_angle = 1e4;  // degrees

/// Tags for OpenRAVE's viewer.
constexpr std::array<std::string_view, 5> viewer_tags{"bkgndcolor", "camtrans", "camrotaxis", "camrotationaxis",
                                                      "camfocal"};

void read_physics(const XmlElement& element, EnvironmentModel& environment, std::vector<std::string>& warnings) {
  constexpr std::array<std::string_view, 1> attributes{"type"};
  std::array<std::string, physics_engines.size()> tags;
  std::ranges::transform(physics_engines, tags.begin(),
                         [](const PhysicsEngineName& engine) { return std::string(engine.word) + "properties"; });
  element.allow(attributes, std::vector<std::string_view>(tags.begin(), tags.end()));
  const std::string type = element.required_attribute("type");
  const std::optional<PhysicsEngine> engine = engine_named(lower_case(type));
  if (!engine) {
    element.refuse("type " + in_quotes(type) + " in " + element.label(), engine_words());
  }
  environment.engine = *engine;
  // All engines have the same properties, so a change of the type alone is enough.
  std::optional<XmlElement> properties;
  for (const std::string& tag : tags) {
    const auto found = element.child(tag);
    if (found && properties) {
      found->refuse(found->label() + " beside " + properties->label(), "one of them");
    }
    properties = found ? found : properties;
  }
  if (!properties) {
    return;
  }
  properties->allow({}, {"gravity", "selfcollision"});
  if (const auto gravity = properties->child("gravity")) {
    environment.gravity = read_vector(*gravity, accelerations);
    std::ranges::move(check_gravity(environment.gravity, {gravity->document().name(), gravity->line()}),
                      std::back_inserter(warnings));
  }
  if (const auto collision = properties->child("selfcollision")) {
    const std::string text = collision->text();
    if (text != "0" && text != "1") {
      collision->refuse(in_quotes(text) + " in " + collision->label(), "0 or 1");
    }
    environment.self_collision = text == "1";
  }
}

/// "x y z" as three numbers from -max to max.
std::optional<Eigen::Vector3d> parse_triple(std::string_view text, double max) {
  const std::vector<std::string_view> tokens = words(text);
  if (tokens.size() != 3) {
    return std::nullopt;
  }
  Eigen::Vector3d result;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> value = parse_number(tokens[i]);
    if (!value || *value < -max || *value > max) {
      return std::nullopt;
    }
    result[static_cast<Eigen::Index>(i)] = *value;
  }
  return result;
}

std::vector<std::string_view> split_at_commas(std::string_view text) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = text.find(',');
    parts.push_back(trimmed(text.substr(0, comma)));
    if (comma == std::string_view::npos) {
      return parts;
    }
    text.remove_prefix(comma + 1);
  }
}

Pose read_robot_pose(const XmlDocument& document) {
  std::optional<Pose> pose;
  for (const XmlDocument::Comment& comment : document.comments()) {
    const std::string_view text = trimmed(comment.text);
    if (!lower_case(text).starts_with("pose:")) {
      continue;
    }
    const std::vector<std::string_view> parts = split_at_commas(text);
    std::optional<Eigen::Vector3d> position;
    std::optional<Eigen::Vector3d> degrees;
    if (parts.size() == 4 && lower_case(parts[0]) == "pose:" && parts[3].empty()) {
      position = parse_triple(parts[1], coordinates.max);
      degrees = parse_triple(parts[2], max_angle);
    }
    if (!position || !degrees || pose) {
      throw InputError(document.name(), comment.line, (pose ? "a second comment " : "the comment ") + in_quotes(text),
                       "one 'Pose: ,X Y Z,A B C,' with metres and degrees");
    }
    const Eigen::Vector3d angles = *degrees * (std::numbers::pi / 180.0);
    pose = Pose{*position, Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX())};
  }
  return pose.value_or(Pose{});
}

Ruler read_ruler(const XmlElement& element) {
  element.allow({}, {"from", "to", "division", "width"});
  Ruler ruler;
  ruler.from = read_vector(element.required_child("from"), coordinates);
  const XmlElement to = element.required_child("to");
  ruler.to = read_vector(to, coordinates);
  if (const auto division = element.child("division")) {
    ruler.division = read_number(*division, lengths);
  }
  if (const auto width = element.child("width")) {
    ruler.width = read_number(*width, lengths);
  }
  const double length = (ruler.to - ruler.from).norm();
  constexpr double max_segments = 1000.0;
  if (length < lengths.min || length > max_segments * ruler.division) {
    to.refuse("a ruler of " + number_text(length) + " m with segments of " + number_text(ruler.division) + " m",
              "1 to " + number_text(max_segments) + " segments");
  }
  return ruler;
}

void add_moving_object(BodyEntry body, EnvironmentModel& environment) {
  constexpr std::size_t max_moving_objects = 200;
  if (environment.moving_objects.size() == max_moving_objects) {
    throw InputError(body.origin.file, body.origin.line,
                     "more than " + std::to_string(max_moving_objects) + " bodies of type 'dynamic'", "at most that");
  }
  if (body.link.geometries.empty()) {
    throw InputError(body.origin.file, body.origin.line,
                     "body " + in_quotes(body.link.name) + " of type 'dynamic' without a <Geom> that touches",
                     "at least one; otherwise it would fall for ever");
  }
  environment.moving_objects.push_back({std::move(body.link.name), body.link.pose, body.link.mass,
                                        std::move(body.link.geometries), std::move(body.link.looks),
                                        std::move(body.origin.file), body.origin.line});
}

/// What is higher above the robot's lowest point, and not under its start position, is no ground but a wall: who starts
/// inside it gets a warning.
constexpr double highest_step = 0.5;  // m

/// How far the robot must be lifted so that none of its links is in the ground, and on which object it then rests.
struct Lift {
  double height = 0.0;  ///< m
  const StaticObject* ground = nullptr;
};

void raise(Lift& lift, double height, const StaticObject& object) {
  if (height > lift.height) {
    lift = {height, &object};
  }
}

/// The lift that puts the robot above each mesh that is under or over one of its links.
Lift lift_onto_meshes(const RobotModel& robot, const EnvironmentModel& environment) {
  Lift lift;
  for (const Link& link : robot.links) {
    const std::optional<Bounds> bounds = bounds_of(link.geometries, environment.robot_pose * link.pose);
    for (const StaticObject& object : environment.objects) {
      for (const Geometry& geometry : object.geometries) {
        if (bounds && geometry.mesh) {
          const std::optional<double> top = highest_over(*geometry.mesh, object.pose * geometry.pose,
                                                         bounds->lowest.head<2>(), bounds->highest.head<2>());
          raise(lift, top.value_or(bounds->lowest.z()) - bounds->lowest.z(), object);
        }
      }
    }
  }
  return lift;
}

std::optional<double> lowest_point(const RobotModel& robot, const Pose& start) {
  std::optional<double> lowest;
  for (const Link& link : robot.links) {
    if (const auto bounds = bounds_of(link.geometries, start * link.pose)) {
      lowest = std::min(lowest.value_or(bounds->lowest.z()), bounds->lowest.z());
    }
  }
  return lowest;
}

/// The greatest depth of any link in a solid; at least 0.
double depth_in(const Geometry& solid, const Pose& body, const RobotModel& robot, const Pose& start) {
  double deepest = 0.0;
  for (const Link& link : robot.links) {
    deepest = std::max(deepest, overlap_depth(link.geometries, start * link.pose, solid, body));
  }
  return deepest;
}

/// A box one of whose axes is vertical, so that its highest point is its whole upper side.
bool is_level_box(const Geometry& geometry, const Pose& body) {
  constexpr double vertical = 1.0 - 1e-12;
  const Eigen::Matrix3d axes = (body * geometry.pose).orientation.toRotationMatrix();
  return geometry.shape == Shape::box && axes.row(2).cwiseAbs().maxCoeff() > vertical;
}

/// Onto the highest level box under the start position that a link is in. If there is nothing around or below the
/// robot, which would fall for ever, onto the lowest of what is above it.
Lift lift_onto_level_ground(const RobotModel& robot, const EnvironmentModel& environment) {
  const std::optional<double> bottom = lowest_point(robot, environment.robot_pose);
  if (!bottom) {
    return {};
  }
  Lift lift;
  Lift from_below;
  bool has_ground = false;
  for (const StaticObject& object : environment.objects) {
    for (const Geometry& geometry : object.geometries) {
      const Bounds bounds = bounds_of(geometry, object.pose);
      if (!contains_from_above(bounds, environment.robot_pose.position)) {
        continue;
      }
      const double height = bounds.highest.z() - *bottom;
      if (bounds.lowest.z() <= *bottom) {
        has_ground = true;
      } else if (from_below.ground == nullptr || height < from_below.height) {
        from_below = {height, &object};
      }
      if (is_level_box(geometry, object.pose) && depth_in(geometry, object.pose, robot, environment.robot_pose) > 0.0) {
        raise(lift, height, object);
      }
    }
  }
  return lift.ground == nullptr && !has_ground ? from_below : lift;
}

struct Overlap {
  double depth = 0.0;  ///< m
  const StaticObject* object = nullptr;
};

/// The deepest overlap of a link and a shape without a mesh that the robot can be lifted onto. highest: of its top, m.
Overlap deepest_overlap(const RobotModel& robot, const EnvironmentModel& environment, const Pose& start,
                        double highest) {
  Overlap deepest;
  for (const StaticObject& object : environment.objects) {
    for (const Geometry& solid : object.geometries) {
      const Bounds bounds = bounds_of(solid, object.pose);
      if (solid.mesh || (bounds.highest.z() > highest && !contains_from_above(bounds, start.position))) {
        continue;
      }
      if (const double depth = depth_in(solid, object.pose, robot, start); depth > deepest.depth) {
        deepest = {depth, &object};
      }
    }
  }
  return deepest;
}

/// Lifts the robot out of an object that is oblique or round, and out of one that only some links are in.
void lift_out_of_solids(const RobotModel& robot, const EnvironmentModel& environment, Lift& lift) {
  constexpr double rounding = 1e-9;   // m
  constexpr double min_step = 0.001;  // m
  constexpr int most_steps = 10'000;  // a thin wall needs many
  Pose start = environment.robot_pose;
  start.position.z() += lift.height;
  const std::optional<double> lowest = lowest_point(robot, start);
  if (!lowest) {
    return;
  }
  const double highest = *lowest + highest_step;
  Overlap overlap = deepest_overlap(robot, environment, start, highest);
  if (overlap.depth <= largest_start_depth) {
    return;
  }
  for (int step = 0; step < most_steps && overlap.depth > rounding; ++step) {
    const double height = std::max(overlap.depth, min_step);
    start.position.z() += height;
    lift = {lift.height + height, overlap.object};
    overlap = deepest_overlap(robot, environment, start, highest);
  }
}

}  // namespace

EnvironmentModel read_environment(const XmlDocument& document, SourceSet& sources, std::vector<std::string>& remarks,
                                  std::vector<std::string>& warnings) {
  const XmlElement root = document.root("Environment");
  constexpr std::array<std::string_view, 2> attributes{"name", "type"};
  constexpr std::array<std::string_view, 3> tags{"physicsengine", "KinBody", "ruler"};
  root.allow(attributes, joined({tags, viewer_tags}));

  if (root.attribute("type")) {
    remark_no_effect_of("type", remarks, root, "only a plug-in of OpenRAVE reads it");
  }
  EnvironmentModel environment;
  if (const auto physics = root.child("physicsengine")) {
    read_physics(*physics, environment, warnings);
  }
  for (const XmlElement& child : root.children()) {
    if (child.is("ruler")) {
      environment.rulers.push_back(read_ruler(child));
    }
    if (!child.is("KinBody")) {
      continue;
    }
    KinBodyContents contents = read_kinbody(child, KinBodyUse::environment, sources, remarks);
    for (BodyEntry& body : contents.bodies) {
      Link& link = body.link;
      for (const Geometry& geometry : link.geometries) {
        if (geometry.heights) {
          std::ranges::move(check_heights(*geometry.heights, body.origin), std::back_inserter(warnings));
        }
      }
      if (body.is_fixed) {
        environment.objects.push_back({std::move(link.name), link.pose, std::move(link.geometries),
                                       std::move(link.looks), std::move(body.origin.file), body.origin.line});
      } else {
        add_moving_object(std::move(body), environment);
      }
    }
  }
  environment.robot_pose = read_robot_pose(document);
  return environment;
}

void lift_onto_ground(const RobotModel& robot, EnvironmentModel& environment, std::vector<std::string>& remarks) {
  Lift lift = lift_onto_level_ground(robot, environment);
  if (const Lift onto_mesh = lift_onto_meshes(robot, environment); onto_mesh.height > lift.height) {
    lift = onto_mesh;
  }
  lift_out_of_solids(robot, environment, lift);
  constexpr double min_lift = 1e-9;  // m
  if (lift.height < min_lift) {
    return;
  }
  environment.robot_pose.position.z() += lift.height;
  remarks.push_back(one_line("the robot starts " + number_text(lift.height * 1000.0) +
                             " mm higher than its start pose says, so that it rests on " +
                             in_quotes(lift.ground->name)));
}

}  // namespace proleg::sim
