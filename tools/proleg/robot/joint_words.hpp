#pragma once

// What users call joints.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace proleg::tools {

/// The joint that a user means: its name, in any case if that is one joint, or the number at the end of one name.
[[nodiscard]] std::optional<unsigned> joint_of(const sim::RobotModel& robot, std::string_view word);

/// A module and its joint, as the user says.
struct Place {
  std::uint8_t node;
  unsigned joint;
};

/// "3=J1,1=J2". Throws InputError, which names --places; also if a module or a joint is named twice.
[[nodiscard]] std::vector<Place> parse_places(const sim::RobotModel& robot, std::string_view words);

}  // namespace proleg::tools
