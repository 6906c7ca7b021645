#pragma once

#include <cstdint>

namespace proleg::sim {

/// Streams of Pcg32 with the scenario's seed. Each use has its own, so that no two draw the same numbers. The kernels
/// use 0 to 63, one for each joint.
namespace random_stream {
inline constexpr std::uint64_t crystals = 1'000'000;  ///< of the modules, plus the joint
inline constexpr std::uint64_t boards = 2'000'000;    ///< plus the joint
inline constexpr std::uint64_t touch_sensors = 3'000'000;
inline constexpr std::uint64_t friction = 4'000'000;  ///< first of the streams with the spreads of trials
inline constexpr std::uint64_t mass = 5'000'000;
inline constexpr std::uint64_t servo_gain = 6'000'000;
inline constexpr std::uint64_t latency = 7'000'000;
inline constexpr std::uint64_t start = 7'500'000;          ///< offsets of the start position
inline constexpr std::uint64_t faults = 8'000'000;         ///< with the seed of a fault schedule
inline constexpr std::uint64_t fault_effects = 9'000'000;  ///< which frames a fault destroys, and the like
}  // namespace random_stream

}  // namespace proleg::sim
