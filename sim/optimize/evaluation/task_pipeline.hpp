#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/evaluation/workers.hpp"

namespace proleg::optimize {

/// Hash of a task: of what its result depends on.
struct TaskHash {
  [[nodiscard]] std::size_t operator()(const Task& task) const;
};

/// Keeps workers busy with tasks that are wanted in some order, and their results until somebody takes them. What is
/// wanted may change at any time.
class TaskPipeline {
 public:
  enum class Results : std::uint8_t {
    of_one_number,    ///< the result of a task depends on its number (through the seed)
    of_every_number,  ///< it does not: one found for another number is as good
  };
  struct Counts {
    std::uint64_t wasted = 0;  ///< results that are not wanted any more, or never were when they came
    double simulated_s = 0.0;
    double workers_s = 0.0;
  };

  /// All must outlive this. store: null for none; results that are wanted when they come are saved there at once.
  TaskPipeline(const Experiment& experiment, Workers& workers, Store* store, Results results);

  /// These, the first ones first, instead of what was wanted before. Others that workers are at run on.
  void want(std::span<const Task> tasks);
  /// Gives workers tasks and takes results: those that are there, or else the first one within the time. Workers that
  /// are idle then wait for the next call: what the optimiser makes of a result may change what is wanted.
  void run(std::chrono::milliseconds timeout);

  /// Whether the result of a wanted task is here.
  [[nodiscard]] bool has(const Task& task) const { return results_.contains(key(task)); }

  struct Found {
    TrialResult result;
    bool restored = false;  ///< from the store
  };
  /// Hands out a result that is here; the task is not wanted any more.
  Found take(const Task& task);

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  struct Known {
    TrialResult result;
    std::uint32_t worker = 0;
    bool restored = false;
    std::optional<std::uint64_t> saved_as;  ///< the number under which the store has it
  };

  [[nodiscard]] Task key(const Task& task) const;
  void drop_unwanted(const std::unordered_map<Task, Task, TaskHash>& wanted_before);
  void give_tasks();
  void receive(Workers::Done done);
  void save(const Task& task, Known& known);

  const Experiment& experiment_;
  Workers& workers_;
  Store* store_;
  Results results_are_;
  std::unordered_map<Task, Task, TaskHash> wanted_;  ///< by their keys
  std::deque<Task> queue_;                           ///< wanted, neither at a worker nor known
  std::unordered_map<std::uint64_t, Task> at_workers_;
  std::unordered_set<Task, TaskHash> keys_at_workers_;
  std::unordered_map<Task, Known, TaskHash> results_;
  Counts counts_;
};

}  // namespace proleg::optimize
