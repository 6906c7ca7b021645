#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/physics/world.hpp"
#include "sim/reduced/chain_batch.hpp"
#include "sim/reduced/robot_chain.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::reduced {

/// Changes when the engine gives other bits for the same world.
inline constexpr int engine_version = 1;

/// A world in the reduced engine. file: the file that messages name. step_s: length of a step, above 0. Throws
/// InputError if the engine does not have what robot or environment needs.
[[nodiscard]] std::unique_ptr<World> make_reduced_world(const RobotModel& robot, const EnvironmentModel& environment,
                                                        double step_s, const std::string& file);

/// What a world is made from.
struct WorldInput {
  const RobotModel* robot;
  const EnvironmentModel* environment;
  double step_s;
  std::string file;  ///< the file that messages name
};

/// The world of chain number `lane` of a batch. If the batch has others, World::step of each makes no step but throws
/// PhysicsError if the world broke down. input: what the chain was made from.
[[nodiscard]] std::unique_ptr<World> make_world(const WorldInput& input, SpatialChain chain,
                                                std::shared_ptr<ChainBatch<Spatial>> batch, std::size_t lane);

/// Worlds that make their steps together, as fast as the processor's vectors allow. Each gives the same bits as alone.
class ReducedWorlds {
 public:
  /// inputs: at least one. kernel: as ChainBatch has it. Throws InputError as make_reduced_world.
  explicit ReducedWorlds(std::span<const WorldInput> inputs, const ChainKernel* kernel = nullptr);

  /// Gives the worlds away, in the order of the inputs. Then they are used between the steps; World::step of each of
  /// them makes no step but throws PhysicsError if the world broke down. They cannot be moved.
  [[nodiscard]] std::vector<std::unique_ptr<World>> take_worlds() { return std::move(worlds_); }
  /// Steps all worlds. Those that broke down have no effect on the others.
  void step();

 private:
  // One batch for each form of chain.
  std::vector<std::shared_ptr<ChainBatch<Planar>>> planar_batches_;
  std::vector<std::shared_ptr<ChainBatch<Spatial>>> spatial_batches_;
  std::vector<std::unique_ptr<World>> worlds_;
};

}  // namespace proleg::sim::reduced
