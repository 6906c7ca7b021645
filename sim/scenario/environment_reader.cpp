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
                                        std::move(body.link.geometries), std::move(body.link.looks)});
}

}  // namespace

EnvironmentModel read_environment(const XmlDocument& document, SourceSet& sources, std::vector<std::string>& remarks,
                                  std::vector<std::string>& warnings) {
  const XmlElement root = document.root("Environment");
  constexpr std::array<std::string_view, 2> attributes{"name", "type"};
  constexpr std::array<std::string_view, 3> tags{"physicsengine", "KinBody", "ruler"};
  root.allow(attributes, joined({tags, viewer_tags}));

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
      if (body.is_fixed) {
        environment.objects.push_back(
            {std::move(link.name), link.pose, std::move(link.geometries), std::move(link.looks)});
      } else {
        add_moving_object(std::move(body), environment);
      }
    }
  }
  environment.robot_pose = read_robot_pose(document);
  return environment;
}

}  // namespace proleg::sim
