#include "tools/proleg/ui/robot_document.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/ui/telemetry_row.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

json vector_json(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

json shapes_json(std::span<const sim::Geometry> geometries) {
  json shapes = json::array();
  for (const sim::Geometry& geometry : geometries) {
    const Eigen::Vector3d& extents = geometry.extents;
    json shape{{"pose", pose_json(geometry.pose)}};
    switch (geometry.shape) {
      case sim::Shape::box:
        shape["kind"] = "box";
        shape["size"] = vector_json(extents);
        break;
      case sim::Shape::sphere:
        shape["kind"] = "sphere";
        shape["size"] = {extents.x(), 0.0, 0.0};
        break;
      case sim::Shape::cylinder:
        shape["kind"] = "cylinder";
        shape["size"] = {extents.x(), extents.y(), 0.0};
        break;
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

json joints_json(const sim::Scenario& scenario) {
  json joints = json::array();
  for (std::size_t j = 0; j < scenario.robot.joints.size(); ++j) {
    const sim::Joint& joint = scenario.robot.joints[j];
    json object{{"name", joint.name},
                {"lower", degrees(joint.lower_limit)},
                {"upper", degrees(joint.upper_limit)},
                {"anchor", vector_json(joint.anchor)},
                {"axis", vector_json(joint.axis)}};
    if (j < scenario.modules.size()) {
      object["node"] = scenario.modules[j].node;
    }
    joints.push_back(std::move(object));
  }
  return joints;
}

json links_json(const sim::RobotModel& robot) {
  json links = json::array();
  for (const sim::Link& link : robot.links) {
    links.push_back({{"name", link.name}, {"pose", pose_json(link.pose)}, {"shapes", shapes_json(link.geometries)}});
  }
  return links;
}

json joints_of(JointMask group) {
  json joints = json::array();
  for (const unsigned joint : group) {
    joints.push_back(joint);
  }
  return joints;
}

json parameter_json(const sim::Scenario& scenario, const ParameterTable& table, unsigned slot, unsigned index) {
  const Slot& used = scenario.kernel.slots[slot];
  const Parameter& parameter = used.algorithm->declaration().parameters[index];
  json object{{"slot", slot + 1},
              {"name", parameter.name},
              {"unit", sim::shown_unit(parameter.unit)},
              {"scale", value_of_step(parameter.unit)},
              {"wraps", wraps(parameter.unit)},
              {"minimum", parameter.minimum},
              {"maximum", parameter.maximum},
              {"default", parameter.default_value},
              {"help", parameter.help},
              {"internal", false},
              {"joints", joints_of(used.group)}};
  json& file = object["file"] = json::array();
  json& wanted = object["wanted"] = json::array();
  json& confirmed = object["confirmed"] = json::array();
  json& tick = object["tick"] = json::array();
  for (const unsigned joint : used.group) {
    const ParameterTable::Values& values =
        table.at({static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(joint), static_cast<std::uint8_t>(index)});
    file.push_back(values.file);
    wanted.push_back(values.wanted);
    confirmed.push_back(values.confirmed);
    tick.push_back(values.tick);
  }
  return object;
}

/// An internal value has no wanted value: it can be overwritten once, a distortion.
json internal_value_json(const sim::Scenario& scenario, unsigned slot, const InternalValue& value) {
  return {{"slot", slot + 1},
          {"name", value.name},
          {"unit", sim::shown_unit(value.unit)},
          {"scale", value_of_step(value.unit)},
          {"wraps", wraps(value.unit)},
          {"help", value.help},
          {"internal", true},
          {"joints", joints_of(scenario.kernel.slots[slot].group)}};
}

}  // namespace

json pose_json(const sim::Pose& pose) {
  const Eigen::Quaterniond& turn = pose.orientation;
  return {pose.position.x(), pose.position.y(), pose.position.z(), turn.w(), turn.x(), turn.y(), turn.z()};
}

json robot_document(const sim::Scenario& scenario, std::string_view kind) {
  json terrain = json::array();
  for (const sim::StaticObject& object : scenario.environment.objects) {
    terrain.push_back(
        {{"name", object.name}, {"pose", pose_json(object.pose)}, {"shapes", shapes_json(object.geometries)}});
  }
  json slots = json::array();
  for (const unsigned slot : sim::used_slots(scenario)) {
    slots.push_back({{"number", slot + 1},
                     {"algorithm", scenario.kernel.slots[slot].algorithm->declaration().name},
                     {"help", scenario.kernel.slots[slot].algorithm->declaration().help},
                     {"joints", joints_of(scenario.kernel.slots[slot].group)}});
  }
  return {{"name", scenario.robot.name},
          {"file", std::filesystem::path(scenario.path).filename().string()},
          {"kind", kind},
          {"joints", joints_json(scenario)},
          {"links", links_json(scenario.robot)},
          {"terrain", std::move(terrain)},
          {"slots", std::move(slots)}};
}

json parameters_document(const sim::Scenario& scenario, const ParameterTable& table) {
  json document = json::array();
  for (const unsigned slot : sim::used_slots(scenario)) {
    const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
    for (unsigned index = 0; index < declaration.parameters.size(); ++index) {
      document.push_back(parameter_json(scenario, table, slot, index));
    }
    for (const InternalValue& value : declaration.internal_values) {
      document.push_back(internal_value_json(scenario, slot, value));
    }
  }
  return document;
}

}  // namespace proleg::tools
