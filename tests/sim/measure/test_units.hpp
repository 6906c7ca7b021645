#pragma once

#include <numbers>

namespace proleg::sim {

/// In radians.
inline constexpr double degree = std::numbers::pi / 180.0;
/// Duration of a tick in tests of measures.
inline constexpr double tick_s = 0.01;
/// Duration of a step of the physics in tests of measures.
inline constexpr double step_s = 0.001;

}  // namespace proleg::sim
