#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/loop/simulation_batch.hpp"
#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// A task with a number that identifies it in the result of Workers::wait().
struct TicketedTask {
  std::uint64_t ticket;
  Task task;
};

/// Workers simulate tasks in other processes. Each has at most one batch of tasks at a time.
class Workers {
 public:
  struct Done {
    std::uint64_t ticket;
    TrialResult result;
    std::uint32_t worker;
  };

  virtual ~Workers() = default;
  [[nodiscard]] virtual std::uint32_t count() const = 0;
  /// Workers without tasks.
  [[nodiscard]] virtual std::uint32_t idle() const = 0;
  /// Tasks that a worker takes at once, at most; above 0. It may change with every result.
  [[nodiscard]] virtual std::size_t most_at_once() const { return std::numeric_limits<std::size_t>::max(); }
  /// Gives an idle worker tasks, at least one, which it simulates together (sim::batch_size).
  virtual void start(std::span<const TicketedTask> batch) = 0;
  /// The next result, or nothing after the timeout. A worker that dies or hangs is replaced and its tasks are repeated,
  /// each alone; messages() reports it. Throws std::runtime_error if three workers died in a task that they had alone,
  /// or no worker is left.
  [[nodiscard]] virtual std::optional<Done> wait(std::chrono::milliseconds timeout) = 0;
  /// Messages for the user since the last call, one line each.
  [[nodiscard]] virtual std::vector<std::string> messages() = 0;
};

/// How many of the waiting tasks a worker gets at once: they are divided evenly, in batches that are worth simulating
/// together. At least 1.
[[nodiscard]] inline std::size_t share_of_worker(const sim::Scenario& scenario, std::size_t waiting,
                                                 const Workers& workers) {
  const std::size_t count = std::max(workers.count(), 1U);
  return std::clamp<std::size_t>((waiting + count - 1) / count, 1,
                                 std::min(sim::batch_size(scenario), workers.most_at_once()));
}

}  // namespace proleg::optimize
