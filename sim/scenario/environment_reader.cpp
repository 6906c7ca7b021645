#include "sim/scenario/environment_reader.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
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

/// Bounds of all geometries of a body; nothing if there are none.
std::optional<Bounds> bounds_of_body(const std::vector<Geometry>& geometries, const Pose& frame) {
  std::optional<Bounds> whole;
  for (const Geometry& geometry : geometries) {
    const Bounds bounds = bounds_of(geometry, frame);
    whole = whole ? Bounds{whole->lowest.cwiseMin(bounds.lowest), whole->highest.cwiseMax(bounds.highest)} : bounds;
  }
  return whole;
}

}  // namespace

EnvironmentModel read_environment(const XmlDocument& document, SourceSet& sources, std::vector<std::string>& remarks,
                                  std::vector<std::string>& warnings) {
  const XmlElement root = document.root("Environment");
  constexpr std::array<std::string_view, 2> attributes{"name", "type"};
  constexpr std::array<std::string_view, 2> tags{"physicsengine", "KinBody"};
  root.allow(attributes, joined({tags, viewer_tags}));

  EnvironmentModel environment;
  if (const auto physics = root.child("physicsengine")) {
    read_physics(*physics, environment, warnings);
  }
  for (const XmlElement& child : root.children()) {
    if (!child.is("KinBody")) {
      continue;
    }
    KinBodyContents contents = read_kinbody(child, KinBodyUse::environment, sources, remarks);
    for (BodyEntry& body : contents.bodies) {
      environment.objects.push_back({std::move(body.link.name), body.link.pose, std::move(body.link.geometries)});
    }
  }
  environment.robot_pose = read_robot_pose(document);
  return environment;
}

void lift_onto_ground(const RobotModel& robot, EnvironmentModel& environment, std::vector<std::string>& remarks) {
  const Eigen::Vector3d& start = environment.robot_pose.position;
  std::optional<double> top;
  const StaticObject* ground = nullptr;
  for (const StaticObject& object : environment.objects) {
    const std::optional<Bounds> bounds = bounds_of_body(object.geometries, object.pose);
    if (bounds && (start.head<2>().array() >= bounds->lowest.head<2>().array()).all() &&
        (start.head<2>().array() <= bounds->highest.head<2>().array()).all() && (!top || bounds->highest.z() > *top)) {
      top = bounds->highest.z();
      ground = &object;
    }
  }
  std::optional<double> bottom;
  for (const Link& link : robot.links) {
    if (const auto bounds = bounds_of_body(link.geometries, environment.robot_pose * link.pose)) {
      bottom = bottom ? std::min(*bottom, bounds->lowest.z()) : bounds->lowest.z();
    }
  }
  constexpr double min_lift = 1e-9;  // m
  if (!top || !bottom || *top - *bottom < min_lift) {
    return;
  }
  environment.robot_pose.position.z() += *top - *bottom;
  remarks.push_back(one_line("the robot starts " + number_text((*top - *bottom) * 1000.0) +
                             " mm higher than its start pose says, so that it rests on " + in_quotes(ground->name)));
}

}  // namespace proleg::sim
