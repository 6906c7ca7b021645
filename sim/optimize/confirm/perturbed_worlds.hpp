#pragma once

// A gait in worlds that differ a little from its scenario.

#include <cstdint>
#include <functional>
#include <vector>

#include "sim/loop/plant.hpp"
#include "sim/optimize/experiment/trials.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// How much the worlds differ.
struct WorldVariation {
  Spread spread;
  double start_m = 0.0;  ///< the start is moved along x and y, each by up to this in either direction
};

struct WorldDistances {
  std::vector<double> distances;  ///< m, ascending
  std::uint32_t failed = 0;       ///< worlds without a distance
};

/// How far a robot has come at the end of a run, in m: by default in any direction.
using DistanceOf = std::function<double(const sim::Plant&)>;

/// Runs the scenario in `count` worlds, in the scenario's engine; the same seed gives the same worlds. progress: called
/// often with the share that is done; it may throw.
[[nodiscard]] WorldDistances distances_in_worlds(const sim::Scenario& scenario, std::uint32_t count, std::uint64_t seed,
                                                 const WorldVariation& variation,
                                                 const std::function<void(double share)>& progress,
                                                 const DistanceOf& distance_of = &sim::Plant::displacement);

}  // namespace proleg::optimize
