#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace proleg::sim {

/// The <robot_control> of a robot's file: the plug-in that drives a robot without Proleg's modules. The simulation
/// ignores it; only the plug-in knows which parameters there are.
struct RobotControlEntry {
  struct Parameter {
    std::string name;
    std::string value;
    std::optional<std::uint32_t> joint;  ///< kernel order; nothing: for all joints
    int line = 0;

    friend bool operator==(const Parameter&, const Parameter&) = default;
  };

  std::string plugin;  ///< a name, or a path relative to the folder of the file
  std::string file;    ///< as messages show it
  std::string folder;  ///< of the file
  int line = 0;        ///< of the element
  std::vector<Parameter> parameters;
};

inline constexpr std::uint8_t max_module_node = 126;  ///< the highest CANopen node id that a module can have

/// The module that drives a joint.
struct ModulePlace {
  std::uint8_t node = 1;                ///< CANopen node id, 1 to max_module_node; unique in the robot
  std::optional<std::uint32_t> serial;  ///< the serial number that the module must have; nothing: any

  friend bool operator==(const ModulePlace&, const ModulePlace&) = default;
};

}  // namespace proleg::sim
