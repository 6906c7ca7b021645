#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/evaluation/worker_process.hpp"
#include "sim/optimize/evaluation/workers.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::optimize {

/// The shipped uniform travelling wave for a fraction of a second. The search space: "amplitude", 10 to 60 degrees by
/// 10, "frequency", 0.5 to 2 Hz by 0.5, "phase_difference", 40 to 70 degrees by 10. The score is the distance.
[[nodiscard]] Experiment small_experiment(double duration_s = 0.3);

/// The same with trials that differ by friction, with fresh random numbers for each evaluation.
[[nodiscard]] Experiment noisy_experiment(std::uint32_t trials = 1, double duration_s = 0.3);

/// Any whole number below the limit.
[[nodiscard]] inline std::uint32_t draw(std::mt19937& random, std::uint32_t limit) {
  return static_cast<std::uint32_t>(random() % limit);
}

/// Any candidate.
[[nodiscard]] Candidate random_candidate(const Experiment& experiment, std::mt19937& random);

/// A made-up result without a simulation: always the same for the same task. It depends on run, number and trial only
/// if the experiment's outcome depends on the seed. Racing gives up what is below its limit.
[[nodiscard]] TrialResult made_up_trial(const Experiment& experiment, const Task& task);

using RunTask = std::function<TrialResult(const Experiment&, const Task&)>;
/// A worker's function that gives the tasks of a batch to this one.
[[nodiscard]] RunTasks one_by_one(RunTask run);

/// Gives a worker one task.
void start(Workers& workers, std::uint64_t ticket, const Task& task);

/// Workers without processes, which finish in any order and sometimes let wait() return without a result.
class MadeUpWorkers final : public Workers {
 public:
  MadeUpWorkers(const Experiment& experiment, std::uint32_t count, std::uint32_t seed, RunTask run = made_up_trial)
      : experiment_(experiment), count_(count), random_(seed), run_(std::move(run)) {}

  [[nodiscard]] std::uint32_t count() const override { return count_; }
  [[nodiscard]] std::uint32_t idle() const override { return count_ - static_cast<std::uint32_t>(busy_.size()); }
  void start(std::span<const TicketedTask> batch) override;
  [[nodiscard]] std::optional<Done> wait(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::vector<std::string> messages() override { return {}; }

  /// All tasks that were started.
  [[nodiscard]] const std::vector<Task>& started() const { return started_; }
  /// The sizes of all batches.
  [[nodiscard]] const std::vector<std::size_t>& batch_sizes() const { return batch_sizes_; }

 private:
  const Experiment& experiment_;
  std::uint32_t count_;
  std::mt19937 random_;
  RunTask run_;
  std::vector<std::vector<TicketedTask>> busy_;
  std::deque<Done> finished_;
  std::vector<Task> started_;
  std::vector<std::size_t> batch_sizes_;
};

/// Bit patterns of the numbers, with texts and flags. Without wall_s, which does not repeat.
[[nodiscard]] std::string exact(const TrialResult& result);
[[nodiscard]] std::string exact(const Evaluation& evaluation);

}  // namespace proleg::optimize
