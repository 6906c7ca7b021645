#pragma once

#include <cstdint>
#include <optional>

namespace proleg::sim {

/// The module that drives a joint.
struct ModulePlace {
  std::uint8_t node = 1;                ///< CANopen node id, 1 to 126; no other module of the robot has it
  std::optional<std::uint32_t> serial;  ///< its serial number, if it must be that very module

  friend bool operator==(const ModulePlace&, const ModulePlace&) = default;
};

}  // namespace proleg::sim
