#include "tools/proleg/ui/draft_document.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/authoring/library_items.hpp"
#include "sim/authoring/robot_kinds.hpp"
#include "sim/authoring/run_change.hpp"
#include "sim/authoring/sensor_change.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/document/robot_document.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

json shape_json(const sim::WorldShape& shape) {
  return {{"type", shape.type},
          {"size", shape.size},
          {"friction", shape.friction ? json(*shape.friction) : json()},
          {"colour", shape.colour ? vector_json(*shape.colour) : json()}};
}

json object_json(const sim::WorldObject& object) {
  json shapes = json::array();
  for (const sim::WorldShape& shape : object.shapes) {
    shapes.push_back(shape_json(shape));
  }
  return {{"name", object.name},
          {"file", object.file},
          {"line", object.line},
          {"editable", object.body.has_value()},
          {"group", object.group ? json(*object.group) : json()},
          {"group_size", object.group_size},
          {"moves", object.moves},
          {"index", object.index},
          {"mass", object.moves ? json(object.mass) : json()},
          {"pose", pose_json(object.pose)},
          {"shapes", std::move(shapes)}};
}

json optional_json(const std::optional<double>& value) { return value ? json(*value) : json(); }

/// An angle that came through radians, in degrees.
double rounded(double degrees) {
  constexpr double per_degree = 1e9;
  return std::round(degrees * per_degree) / per_degree;
}

json sensor_json(const sim::SensorContents& contents) {
  constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
  const sim::AttachedSensor& sensor = contents.sensor;
  json document{{"name", sensor.name},
                {"kind", name_of(sensor.kind)},
                {"part", sensor.part},
                {"part_name", contents.part},
                {"pose", pose_json(sensor.pose)}};
  if (sensor.kind == sim::SensorKind::touch) {
    document["extents"] = sensor.extents ? vector_json(*sensor.extents) : json();
    document["input"] = sensor.input ? json(*sensor.input == sim::TouchInput::front ? "front" : "rear") : json();
  } else if (sensor.kind == sim::SensorKind::laser) {
    const sim::LaserScan& scan = sensor.scan;
    document["minangle"] = rounded(scan.first_angle * degrees_per_radian);
    document["maxangle"] =
        (scan.first_angle + static_cast<double>(scan.rays - 1) * scan.angle_step) * degrees_per_radian;
    document["resolution"] = rounded(scan.angle_step * degrees_per_radian);
    document["maxrange"] = scan.range;
    document["scantime"] = scan.period_us * 1e-6;
  }
  return document;
}

}  // namespace

json robot_json(const sim::RobotContents& robot, const sim::Scenario& scenario) {
  json joints = json::array();
  for (const sim::JointContents& joint : robot.joints) {
    joints.push_back({{"name", joint.name},
                      {"editable", joint.is_editable},
                      {"axis", vector_json(joint.axis)},
                      {"limits", {rounded(joint.lower_deg), rounded(joint.upper_deg)}},
                      {"torque", joint.max_torque},
                      {"speed", joint.max_speed}});
  }
  json links = json::array();
  for (const sim::LinkContents& link : robot.links) {
    links.push_back({{"name", link.name},
                     {"file", link.file},
                     {"same", link.same_count},
                     {"mass", link.mass},
                     {"friction", optional_json(link.friction)}});
  }
  json sensors = json::array();
  for (const sim::SensorContents& sensor : robot.sensors) {
    sensors.push_back(sensor_json(sensor));
  }
  json kinds = json::array();
  for (const sim::OwnKindContents& kind : robot.kinds) {
    kinds.push_back({{"name", kind.name}, {"length", kind.length}});
  }
  const sim::ServoModel& servo = scenario.robot.servo;
  return {{"file", robot.file},
          {"name", scenario.robot.name},
          {"joints", std::move(joints)},
          {"links", std::move(links)},
          {"sensors", std::move(sensors)},
          {"kinds", std::move(kinds)},
          {"servo",
           {{"gain", servo.gain},
            {"period", servo.period_us / 1e3},
            {"command_speed", servo.command_speed},
            {"latency", servo.latency_us / 1e3}}},
          {"obstacle", robot.obstacle ? json(*robot.obstacle) : json()}};
}

json behaviour_json(const sim::Scenario& scenario) {
  json modules = json::array();
  for (const unsigned slot : sim::used_slots(scenario)) {
    const Slot& used = scenario.kernel.slots[slot];
    const Declaration& declaration = used.algorithm->declaration();
    json joints = json::array();
    for (const unsigned joint : used.group) {
      joints.push_back(joint);
    }
    json values = json::object();
    for (unsigned number = 0; number < declaration.parameters.size(); ++number) {
      json& of_joints = values[std::string(declaration.parameters[number].name)] = json::array();
      for (const unsigned joint : used.group) {
        of_joints.push_back(start_value(scenario, slot, joint, number));
      }
    }
    modules.push_back({{"algorithm", declaration.name}, {"joints", std::move(joints)}, {"values", std::move(values)}});
  }
  return {{"file", scenario.actuation_file}, {"modules", std::move(modules)}};
}

json parts_json() {
  json kinds = json::array();
  for (const sim::RobotKind& kind : sim::robot_kinds()) {
    kinds.push_back({{"name", kind.name}, {"help", kind.help}, {"axes", kind.axes}, {"joints", kind.joints}});
  }
  json sensors = json::array();
  for (const auto& [kind, help] :
       {std::pair(sim::SensorKind::touch, "feels when a side of a link touches something"),
        std::pair(sim::SensorKind::laser, "measures the distance to what is in front of it"),
        std::pair(sim::SensorKind::inclinometer, "measures how far a link leans"),
        std::pair(sim::SensorKind::accelerometer, "measures jolts of a link"),
        std::pair(sim::SensorKind::servo_current, "measures the current of the servo of a joint")}) {
    sensors.push_back({{"kind", name_of(kind)}, {"help", help}, {"at_joint", kind == sim::SensorKind::servo_current}});
  }
  return {{"kinds", std::move(kinds)},
          {"sensors", std::move(sensors)},
          {"places", sim::sensor_places()},
          {"most_joints", max_joints},
          {"most_modules", max_slots}};
}

json run_json(const sim::Scenario& scenario) {
  const sim::EnvironmentModel& environment = scenario.environment;
  return {{"duration", scenario.duration_s},
          {"seed", std::to_string(scenario.kernel.seed)},
          {"tick", scenario.kernel.tick_period_us / 1e3},
          {"step", scenario.step_s * 1e3},
          {"solver", sim::word_of(scenario.solver)},
          {"contact_noise", scenario.contact_noise},
          {"engine", sim::name_of(environment.engine)},
          {"gravity", vector_json(environment.gravity)},
          {"self_collision", environment.self_collision}};
}

json world_json(const sim::WorldContents& world) {
  json objects = json::array();
  for (const sim::WorldObject& object : world.objects) {
    objects.push_back(object_json(object));
  }
  json rulers = json::array();
  for (const sim::WorldRuler& ruler : world.rulers) {
    rulers.push_back({{"from", vector_json(ruler.from)}, {"to", vector_json(ruler.to)}});
  }
  return {{"file", world.file},
          {"objects", std::move(objects)},
          {"rulers", std::move(rulers)},
          {"start", {{"position", vector_json(world.start)}, {"degrees", vector_json(world.start_degrees)}}}};
}

json library_json() {
  json items = json::array();
  for (const sim::LibraryDeclaration& declaration : sim::library()) {
    json parameters = json::array();
    for (const sim::LibraryParameter& parameter : declaration.parameters) {
      parameters.push_back({{"name", parameter.name},
                            {"help", parameter.help},
                            {"unit", parameter.unit},
                            {"lowest", parameter.lowest},
                            {"highest", parameter.highest},
                            {"usual", parameter.usual},
                            {"whole", parameter.is_whole}});
    }
    items.push_back({{"name", declaration.name}, {"help", declaration.help}, {"parameters", std::move(parameters)}});
  }
  return items;
}

}  // namespace proleg::tools
