#include "sim/hardware_loop/master_input.hpp"

#include "sim/scenario/module_sensors.hpp"

namespace proleg::sim {

static_assert(max_module_node == canopen::max_node_id);

MasterInput::MasterInput(const Scenario& scenario) : changes(scenario.changes) {
  require_sensors(scenario, sensors_of_modules, "a module");
  for (const ModulePlace& module : scenario.modules) {
    nodes_.push_back(module.node);
    serials.push_back(module.serial.value_or(0));
  }
  setup.kernel = scenario.kernel;
  setup.servo_period_us = scenario.robot.servo.period_us;
  setup.command_speed = scenario.robot.servo.command_speed;
  setup.nodes = nodes_;
  setup.limits = scenario.joint_limits;
  setup.start_values = scenario.settings;
}

std::string name_of_node(const Scenario& scenario, std::uint8_t node) {
  for (std::size_t joint = 0; joint < scenario.modules.size(); ++joint) {
    if (scenario.modules[joint].node == node) {
      return "node " + std::to_string(node) + " (" + scenario.robot.joints[joint].name + ")";
    }
  }
  return "node " + std::to_string(node);
}

}  // namespace proleg::sim
