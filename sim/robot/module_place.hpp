#pragma once

#include <cstdint>
#include <optional>

namespace proleg::sim {

inline constexpr std::uint8_t max_module_node = 126;  ///< the highest CANopen node id that a module can have

/// The module that drives a joint.
struct ModulePlace {
  std::uint8_t node = 1;                ///< CANopen node id, 1 to max_module_node; unique in the robot
  std::optional<std::uint32_t> serial;  ///< the serial number that the module must have; nothing: any

  friend bool operator==(const ModulePlace&, const ModulePlace&) = default;
};

}  // namespace proleg::sim
