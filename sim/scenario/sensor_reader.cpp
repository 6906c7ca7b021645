#include "sim/scenario/robot_reader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;
constexpr Range scan_angles{-360.0, 360.0, "degrees"};
constexpr Range resolutions{1e-3, 360.0, "degrees"};
constexpr Range laser_ranges{1e-3, 1e4, "m"};
constexpr Range scan_times{1e-3, 3600.0, "s"};

constexpr std::array<std::string_view, 1> sensor_attributes{"type"};
constexpr std::array<std::string_view, 2> common_tags{"power", "render"};
constexpr std::array kinds{SensorKind::touch, SensorKind::laser, SensorKind::servo_current, SensorKind::inclinometer,
                           SensorKind::accelerometer};

SensorKind read_kind(const XmlElement& element) {
  const std::string type = element.required_attribute("type");
  std::vector<std::string> names;
  for (const SensorKind kind : kinds) {
    names.emplace_back(name_of(kind));
    if (lower_case(type) == lower_case(names.back())) {
      return kind;
    }
  }
  element.refuse("type " + in_quotes(type) + " in " + element.label(), "one of " + listed(names));
}

void read_touch(const XmlElement& element, AttachedSensor& sensor) {
  constexpr std::array<std::string_view, 2> tags{"extents", "input"};
  element.allow(sensor_attributes, sim::joined({tags, common_tags}));
  if (const auto extents = element.child("extents")) {
    sensor.extents = read_vector(*extents, lengths);
  }
  if (const auto input = element.child("input")) {
    sensor.input = read_choice(*input, {"rear", "front"}) == 0 ? TouchInput::rear : TouchInput::front;
  }
}

void read_laser(const XmlElement& element, AttachedSensor& sensor) {
  constexpr std::array<std::string_view, 5> tags{"minangle", "maxangle", "resolution", "maxrange", "scantime"};
  element.allow(sensor_attributes, sim::joined({tags, common_tags}));
  const XmlElement max = element.required_child("maxangle");
  const double first = read_number(element.required_child("minangle"), scan_angles);
  const double last = read_number(max, scan_angles);
  if (last < first) {
    max.refuse("<maxangle> " + number_text(last), "at least <minangle>, " + number_text(first));
  }
  if (last - first > 360.0) {
    max.refuse(number_text(last - first) + " degrees from <minangle> to <maxangle>", "at most 360");
  }
  const XmlElement resolution = element.required_child("resolution");
  const double step = read_number(resolution, resolutions);
  constexpr double rounding = 1e-9;  // 0.1 degrees are no binary fraction
  const double steps = std::floor((last - first) / step + rounding);
  if (steps + 1.0 > static_cast<double>(max_laser_rays)) {
    resolution.refuse(number_text(steps + 1.0) + " rays", "at most " + std::to_string(max_laser_rays));
  }
  sensor.scan = {first * radians_per_degree, step * radians_per_degree, static_cast<std::size_t>(steps) + 1,
                 read_number(element.required_child("maxrange"), laser_ranges), 0};
  if (const auto time = element.child("scantime")) {
    sensor.scan.period_us = static_cast<std::uint32_t>(std::llround(read_number(*time, scan_times) * 1e6));
  }
}

void read_properties(const XmlElement& element, AttachedSensor& sensor, std::vector<std::string>& remarks) {
  sensor.kind = read_kind(element);
  if (sensor.kind == SensorKind::touch) {
    read_touch(element, sensor);
  } else if (sensor.kind == SensorKind::laser) {
    read_laser(element, sensor);
  } else {
    element.allow(sensor_attributes, common_tags);
  }
  if (const auto render = element.child("render")) {
    remark_no_effect(remarks, *render, "only the thesis's viewer draws sensors");
  }
}

bool has_power(const XmlElement& element) {
  const auto power = element.child("power");
  return !power || read_whole(*power, 0, 1) == 1;
}

std::size_t read_link(const XmlElement& element, const RobotModel& model) {
  const std::string name = element.text();
  const auto link = std::ranges::find(model.links, name, &Link::name);
  if (link == model.links.end()) {
    std::vector<std::string> names;
    for (const Link& known : model.links) {
      names.push_back(known.name);
    }
    element.refuse("unknown link " + in_quotes(name), "one of " + listed(names));
  }
  return static_cast<std::size_t>(link - model.links.begin());
}

std::size_t read_joint_name(const XmlElement& element, const RobotModel& model) {
  const std::string name = element.text();
  const int joint = find_joint(model, name);
  if (joint < 0) {
    element.refuse("unknown joint " + in_quotes(name), "one of " + listed(joint_names(model)));
  }
  return static_cast<std::size_t>(joint);
}

void check_against(const std::vector<AttachedSensor>& others, const AttachedSensor& sensor, const XmlElement& element) {
  for (const AttachedSensor& other : others) {
    const std::string where = "; the first is in line " + std::to_string(other.line);
    if (other.name == sensor.name) {
      element.refuse("a second sensor " + in_quotes(sensor.name), "another name" + where);
    }
    if (sensor.input && other.input == sensor.input && other.part == sensor.part) {
      element.refuse("a second sensor at the input '" +
                         std::string(*sensor.input == TouchInput::rear ? "rear" : "front") + "' of this link",
                     "one" + where);
    }
  }
}

}  // namespace

std::vector<AttachedSensor> read_sensors(const XmlElement& robot, const RobotModel& model, SourceSet& sources,
                                         std::vector<std::string>& remarks) {
  std::vector<AttachedSensor> sensors;
  for (const XmlElement& element : robot.children()) {
    if (!element.is("AttachedSensor")) {
      continue;
    }
    if (sensors.size() == max_attached_sensors) {
      element.refuse("more than " + std::to_string(max_attached_sensors) + " sensors",
                     "at most " + std::to_string(max_attached_sensors));
    }
    constexpr std::array<std::string_view, 1> attributes{"name"};
    constexpr std::array<std::string_view, 3> tags{"link", "joint", "sensor"};
    element.allow(attributes, sim::joined({tags, pose_tags}));
    AttachedSensor sensor;
    sensor.file = element.document().name();
    sensor.line = element.line();
    sensor.name = checked_name(element, element.required_attribute("name"));
    sensor.pose = read_pose(element);
    const XmlElement description = element.required_child("sensor");
    std::unique_ptr<XmlDocument> document;  // outlives its elements
    std::optional<XmlElement> properties = description;
    if (const auto file = description.attribute("file")) {
      description.allow({"file"}, {});
      document = sources.open(description, *file);
      properties = document->root("sensor");
    }
    read_properties(*properties, sensor, remarks);
    const bool is_of_joint = sensor.kind == SensorKind::servo_current;
    const std::string_view wanted = is_of_joint ? "joint" : "link";
    if (const auto other = element.child(is_of_joint ? "link" : "joint")) {
      other->refuse(other->label() + " of a sensor of type " + std::string(name_of(sensor.kind)),
                    "<" + std::string(wanted) + ">");
    }
    const XmlElement part = element.required_child(wanted);
    sensor.part = is_of_joint ? read_joint_name(part, model) : read_link(part, model);
    if (!has_power(*properties)) {
      remarks.push_back(one_line(sensor.file + ":" + std::to_string(sensor.line) + ": sensor " +
                                 in_quotes(sensor.name) + " is switched off"));
      continue;
    }
    check_against(sensors, sensor, element);
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

}  // namespace proleg::sim
