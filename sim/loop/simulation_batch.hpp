#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/loop/simulation.hpp"
#include "sim/reduced/reduced_world.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// How many simulations of such scenarios are worth making together: more than 1 if the engine steps many worlds at
/// once and no move puts the robot elsewhere.
[[nodiscard]] std::size_t batch_size(const Scenario& scenario);

/// Simulations in the reduced engine that make their steps together. Each gives the same bits as alone; none has
/// hashes.
class SimulationBatch {
 public:
  /// scenarios: at least one, for the reduced engine, with the same tick and step, without moves. They must outlive
  /// this. kernel: nothing: the fastest one. Throws InputError if the engine does not have what one of them needs.
  explicit SimulationBatch(std::span<const Scenario* const> scenarios, const reduced::ChainKernel* kernel = nullptr);

  [[nodiscard]] std::size_t size() const { return members_.size(); }
  [[nodiscard]] const Simulation& simulation(std::size_t i) const { return *members_[i].simulation; }
  /// Why a simulation failed; empty if it did not.
  [[nodiscard]] const std::string& failure(std::size_t i) const { return members_[i].failure; }
  /// From now on a simulation makes no tick: nobody needs its result.
  void stop(std::size_t i) { members_[i].runs = false; }
  [[nodiscard]] bool runs(std::size_t i) const { return members_[i].runs; }

  /// A tick of all simulations that run. One that fails stops.
  void advance();

 private:
  struct Member {
    std::unique_ptr<Simulation> simulation;
    bool runs = true;
    std::string failure{};
  };

  template <typename Do>
  void for_all(const Do& act);

  reduced::ReducedWorlds worlds_;
  std::vector<Member> members_;
};

}  // namespace proleg::sim
