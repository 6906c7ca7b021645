#pragma once

#include "tests/bench/evaluation.hpp"
#include "tests/bench/mujoco/mujoco_model.hpp"

namespace proleg::bench {

/// As evaluate(), but the world is MuJoCo's: the same kernels, pulses and servos. model: write_mjcf() of the scenario,
/// compiled; candidates of an optimiser share it. Touch sensors feel nothing, and servos have no latency.
[[nodiscard]] Evaluation evaluate_in_mujoco(const sim::Scenario& scenario, const Workload& workload,
                                            const mjModel& model);

}  // namespace proleg::bench
