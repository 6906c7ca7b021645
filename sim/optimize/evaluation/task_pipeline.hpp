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

/// Hash of all fields of a task.
struct TaskHash {
  [[nodiscard]] std::size_t operator()(const Task& task) const;
};

/// Gives workers the tasks that are wanted, in their order, and keeps the results until they are claimed. What is
/// wanted may change at any time.
class TaskPipeline {
 public:
  enum class ResultScope : std::uint8_t {
    one_number,   ///< the result of a task depends on its number (fresh random numbers)
    all_numbers,  ///< it does not: a result for another number is the same
  };
  struct Counts {
    std::uint64_t wasted = 0;  ///< results that are no longer wanted, or were not when they arrived
    double simulated_s = 0.0;
    double workers_s = 0.0;
  };

  /// All must outlive this. store: null for none. Results that are wanted when they arrive are saved at once.
  TaskPipeline(const Experiment& experiment, Workers& workers, Store* store, ResultScope result_scope);

  /// Replaces the wanted tasks; the first ones are simulated first. Tasks that workers already have continue.
  void set_wanted(std::span<const Task> tasks);
  /// Gives idle workers tasks and collects results: all that are ready, or else the first one within the time. Workers
  /// that are idle afterwards wait for the next call: the optimiser may request other tasks after a result.
  void run(std::chrono::milliseconds timeout);

  /// Whether the result of a wanted task has arrived.
  [[nodiscard]] bool has_result(const Task& task) const { return results_.contains(key(task)); }

  struct ClaimedResult {
    TrialResult result;
    bool restored = false;  ///< from the store
  };
  /// Moves a result out. It must have arrived; its task is no longer wanted.
  ClaimedResult claim_result(const Task& task);

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  struct KeptResult {
    TrialResult result;
    std::uint32_t worker = 0;
    bool restored = false;
    std::optional<std::uint64_t> saved_as;  ///< its number in the store
  };

  [[nodiscard]] Task key(const Task& task) const;
  void drop_unwanted(const std::unordered_map<Task, Task, TaskHash>& wanted_before);
  void give_tasks();
  void receive(Workers::Done done);
  void save(const Task& task, KeptResult& known);

  const Experiment& experiment_;
  Workers& workers_;
  Store* store_;
  ResultScope result_scope_;
  std::unordered_map<Task, Task, TaskHash> wanted_;  ///< by their keys
  std::deque<Task> queue_;                           ///< wanted, without a worker or a result
  std::unordered_map<std::uint64_t, Task> at_workers_;
  std::unordered_set<Task, TaskHash> keys_at_workers_;
  std::unordered_map<Task, KeptResult, TaskHash> results_;
  Counts counts_;
};

}  // namespace proleg::optimize
