#pragma once

// The chains whose states are hashed.

#include <cstddef>
#include <vector>

#include "sim/reduced/chain_batch.hpp"

namespace proleg::sim::reduced::golden {

inline constexpr std::size_t chain_count = 16;
inline constexpr std::size_t link_count = 6;
inline constexpr std::size_t joint_count = link_count - 1;

/// They differ in mass, friction, gravity and start. The terrain has a floor, a step and a hill.
[[nodiscard]] std::vector<ChainModel<Planar>> make_chains();
/// As many. Their joints have different axes; the floor is level and not so large that no chain leaves it.
[[nodiscard]] std::vector<ChainModel<Spatial>> make_snakes();

/// Of a motor, Nm. Some are too weak for what they shall do, some give none. chain: its number among make_chains() or
/// make_snakes().
[[nodiscard]] double max_torque(std::size_t chain, std::size_t joint);

/// Of a motor in a step, rad/s. Some gaits roll the chain up, so that its ends touch.
[[nodiscard]] double wanted_speed(std::size_t chain, std::size_t joint, std::size_t step);

}  // namespace proleg::sim::reduced::golden
