#pragma once

#include <cstddef>
#include <memory>

#include "sim/physics/world.hpp"
#include "sim/reduced/spatial_batch.hpp"
#include "sim/reduced/spatial_chain.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::reduced {

/// The world of chain number `lane` of a batch. If the batch has others, World::step of each makes no step but throws
/// PhysicsError if the world broke down.
[[nodiscard]] std::unique_ptr<World> make_spatial_world(const RobotModel& robot, SpatialChain chain,
                                                        std::shared_ptr<SpatialBatch> batch, std::size_t lane);

}  // namespace proleg::sim::reduced
