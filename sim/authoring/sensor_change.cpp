#include "sim/authoring/sensor_change.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/robot/bounds.hpp"

namespace proleg::sim {
namespace {

/// The way out of each side, in the frame of a link that lies along y: its left is at negative x.
constexpr std::array<std::array<double, 3>, 6> ways{
    {{0, 1, 0}, {0, -1, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, -1}}};

/// The first part of a new sensor's name.
std::string_view word_of(SensorKind kind) {
  switch (kind) {
    case SensorKind::touch:
      return "touch";
    case SensorKind::laser:
      return "eye";
    case SensorKind::servo_current:
      return "current";
    case SensorKind::inclinometer:
      return "level";
    case SensorKind::accelerometer:
      break;
  }
  return "shock";
}

/// The box around a link, in its frame; a point at the origin if it has no geometry.
Bounds bounds_in_frame(const Link& link) {
  Bounds bounds{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = 0; i < link.geometries.size(); ++i) {
    const Bounds one = bounds_of(link.geometries[i], Pose{});
    bounds = i == 0 ? one : joined(bounds, one);
  }
  return bounds;
}

}  // namespace

const std::vector<std::string_view>& sensor_places() {
  static const std::vector<std::string_view> places{"front", "rear", "left", "right", "above", "below"};
  return places;
}

const SensorContents& SensorChange::at(std::size_t sensor) const {
  if (sensor >= robot_.sensors.size()) {
    throw InputError("sensor", 0, std::to_string(sensor), "a number below " + std::to_string(robot_.sensors.size()));
  }
  return robot_.sensors[sensor];
}

const std::string& SensorChange::part_name(SensorKind kind, std::size_t part) const {
  const bool is_at_joint = kind == SensorKind::servo_current;
  const std::size_t count = is_at_joint ? robot_.joints.size() : robot_.links.size();
  if (part >= count) {
    throw InputError(is_at_joint ? "joint" : "link", 0, std::to_string(part),
                     "a number below " + std::to_string(count));
  }
  return is_at_joint ? robot_.joints[part].name : robot_.links[part].name;
}

void SensorChange::add(SensorKind kind, std::size_t part, SensorPlace place) {
  const std::string& part_text = part_name(kind, part);
  std::string name(word_of(kind));
  const auto is_taken = [this](const std::string& candidate) {
    return std::ranges::any_of(robot_.sensors, [&](const auto& other) { return other.sensor.name == candidate; });
  };
  for (unsigned number = 2; is_taken(name); ++number) {
    name = std::string(word_of(kind)) + " " + std::to_string(number);
  }
  std::string pose;
  std::string properties;
  if (kind == SensorKind::touch || kind == SensorKind::laser) {
    const Bounds bounds = bounds_in_frame(scenario_.robot.links[part]);
    const Eigen::Vector3d way(ways.at(static_cast<std::size_t>(place)).data());
    const Eigen::Vector3d middle = (bounds.lowest + bounds.highest) / 2.0;
    const Eigen::Vector3d half = (bounds.highest - bounds.lowest) / 2.0;
    pose = "  " + element_text("translation", vector_text(middle + half.cwiseProduct(way))) + "\n";
    if (kind == SensorKind::touch) {
      constexpr double depth = 0.004;  // m
      const Eigen::Vector3d box = half - half.cwiseProduct(way.cwiseAbs()) + depth * way.cwiseAbs();
      properties = "\n    " + element_text("extents", vector_text(box));
    } else {
      const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), way);
      if (const auto rotation = rotation_text(turn)) {
        pose += "  " + element_text("rotationaxis", *rotation) + "\n";
      }
      properties =
          "\n    <minangle>-30</minangle>\n    <maxangle>30</maxangle>\n    <resolution>5</resolution>\n"
          "    <maxrange>1</maxrange>";
    }
  }
  const std::string tag = kind == SensorKind::servo_current ? "joint" : "link";
  const std::string start = "<AttachedSensor name=\"" + escaped_xml(name) + "\">\n  " + element_text(tag, part_text) +
                            "\n" + pose + "  <sensor type=\"" + std::string(name_of(kind)) + "\"";
  const std::string end = properties.empty() ? "/>" : ">" + properties + "\n  </sensor>";
  const std::vector<ElementNumber> all = xml().children(0, "AttachedSensor");
  const std::string lines = start + end + "\n</AttachedSensor>";
  change_.apply(robot_.file, all.empty() ? xml().add_last(0, lines) : xml().add_behind(all.back(), lines));
}

void SensorChange::remove(std::size_t sensor) { change_.apply(robot_.file, xml().remove(at(sensor).element)); }

void SensorChange::rename(std::size_t sensor, const std::string& name) {
  change_.apply(robot_.file, xml().set_attribute(at(sensor).element, "name", name));
}

void SensorChange::place(std::size_t sensor, const Pose& pose) {
  const ElementNumber element = at(sensor).element;
  if (!xml().child(element, "translation") && !pose.position.isZero(1e-9)) {
    // Behind the name of the link, where people write it.
    const auto part = xml().child(element, "link");
    if (part) {
      change_.apply(robot_.file, xml().add_behind(*part, element_text("translation", vector_text(pose.position))));
    }
  }
  set_pose(change_, robot_.file, element, pose);
}

void SensorChange::set_part(std::size_t sensor, std::size_t part) {
  const SensorContents& contents = at(sensor);
  const std::string_view tag = contents.sensor.kind == SensorKind::servo_current ? "joint" : "link";
  set_tag(change_, robot_.file, contents.element, tag, part_name(contents.sensor.kind, part));
}

void SensorChange::set_property(std::size_t sensor, std::string_view tag, const std::string& content) {
  const SensorContents& contents = at(sensor);
  const std::optional<ElementNumber> description = xml().child(contents.element, "sensor");
  if (!description || xml().attribute(*description, "file")) {
    throw InputError("sensor", 0, in_quotes(contents.sensor.name) + ", which is described in " + contents.sensor.file,
                     "a sensor that is described in " + robot_.file);
  }
  if (!content.empty()) {
    set_tag(change_, robot_.file, *description, tag, content);
  } else if (const auto child = xml().child(*description, tag)) {
    change_.apply(robot_.file, xml().remove(*child));
  }
}

}  // namespace proleg::sim
