#pragma once

// The first seconds of a scenario: what a picture of it shows.

#include <chrono>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sim/robot/pose.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

inline constexpr double preview_seconds = 10.0;

struct GaitPreview {
  std::vector<sim::Pose> start;                 ///< poses of the links in the world
  std::vector<std::vector<sim::Pose>> moments;  ///< the same at four moments of the last stride, or at the start only
  std::vector<sim::Pose> objects;               ///< of the objects that move, at the last moment
  std::vector<Eigen::Vector3d> path;            ///< of the head's frame, each 0.1 s; only the start if it did not move
  std::optional<double> distance;               ///< m in preview_seconds; nothing: the run has not come so far
};

/// Simulates the scenario with the fastest engine that has it. longest: processor time; a run that needs more is given
/// up, and so is one that fails: then the preview is the start. is_outdated: asked after each tick; if it is true the
/// preview does not matter any more. Throws InputError if no engine has such a scenario.
[[nodiscard]] GaitPreview preview_of(sim::Scenario scenario, std::chrono::milliseconds longest,
                                     const std::function<bool()>& is_outdated);

}  // namespace proleg::tools
