#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/physics/world.hpp"
#include "sim/reduced/chain_batch.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::reduced {

/// A world in the reduced engine. file: that messages name. step_s: length of a step, above 0. Throws InputError if the
/// engine does not have what robot or environment needs.
[[nodiscard]] std::unique_ptr<World> make_reduced_world(const RobotModel& robot, const EnvironmentModel& environment,
                                                        double step_s, const std::string& file);

}  // namespace proleg::sim::reduced
