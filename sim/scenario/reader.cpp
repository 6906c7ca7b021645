#include "sim/scenario/reader.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "sim/scenario/actuation_reader.hpp"
#include "sim/scenario/environment_reader.hpp"
#include "sim/scenario/plausibility.hpp"
#include "sim/scenario/properties_reader.hpp"
#include "sim/scenario/robot_reader.hpp"
#include "sim/scenario/source_set.hpp"
#include "sim/scenario/start_lift.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {

Scenario read_scenario(const std::filesystem::path& path, FileSource& files, const Overrides& overrides) {
  Scenario scenario;
  scenario.path = path.string();
  scenario.overrides = overrides;
  SourceSet sources(files, path, scenario.sources);
  const auto top = sources.open_top();
  const XmlElement root = top->root("simulation");
  root.allow({}, {"robot", "actuation", "environment", "simulationProperties", "sensor", "sensors"});
  const auto open = [&](std::string_view tag) {
    const XmlElement mention = root.required_child(tag);
    return sources.open(mention, mention.text());
  };

  if (const auto properties = root.child("simulationProperties")) {
    read_simulation_properties(*properties, scenario);
  }
  scenario.kernel.seed = overrides.seed.value_or(scenario.kernel.seed);
  for (const XmlElement& child : root.children()) {
    if (child.is("sensor") || child.is("sensors")) {
      remark_no_effect(scenario.remarks, child, "every link has two touch sensors under it");
    }
  }

  const auto robot_file = open("robot");
  RobotDescription robot = read_robot(*robot_file, scenario.step_s, sources, scenario.remarks);
  scenario.robot = std::move(robot.model);
  scenario.joint_limits = std::move(robot.kernel_limits);
  scenario.modules = std::move(robot.modules);
  scenario.robot_control = std::move(robot.robot_control);
  scenario.warnings = std::move(robot.warnings);
  scenario.kernel.joint_count = static_cast<std::uint8_t>(scenario.robot.joints.size());

  const auto actuation_file = open("actuation");
  scenario.actuation_file = actuation_file->name();
  read_actuation(*actuation_file, scenario, robot_file->name());

  const auto environment_file = open("environment");
  scenario.environment = read_environment(*environment_file, sources, scenario.remarks, scenario.warnings);
  apply_overrides(overrides, scenario.environment);
  lift_onto_ground(scenario.robot, scenario.environment, scenario.remarks);
  std::ranges::move(check_start(scenario.robot.links, scenario.environment, environment_file->name()),
                    std::back_inserter(scenario.warnings));
  return scenario;
}

}  // namespace proleg::sim
