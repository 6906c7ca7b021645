#pragma once

#include <span>

#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The rigid motion of a move: from where the links are to where it puts them. A robot that would be inside or
/// below the environment is put on top of it. Throws InputError if that takes more than a metre, if nothing is below
/// that place, or if it is more than 10 m above the ground.
[[nodiscard]] Pose placement(const RobotMove& move, std::span<const Pose> links, const Scenario& scenario);

}  // namespace proleg::sim
