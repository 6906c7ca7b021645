#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// Workers simulate tasks in other processes. Each has at most one task at a time.
class Workers {
 public:
  struct Done {
    std::uint64_t ticket;
    TrialResult result;
    std::uint32_t worker;
  };

  virtual ~Workers() = default;
  [[nodiscard]] virtual std::uint32_t count() const = 0;
  /// Workers without a task.
  [[nodiscard]] virtual std::uint32_t idle() const = 0;
  /// Gives an idle worker a task. ticket: identifies the task in the result of wait().
  virtual void start(std::uint64_t ticket, const Task& task) = 0;
  /// The next result, or nothing after the timeout. A worker that dies or hangs is replaced and its task repeated;
  /// messages() reports it. Throws std::runtime_error if three workers died in a task, or no worker is left.
  [[nodiscard]] virtual std::optional<Done> wait(std::chrono::milliseconds timeout) = 0;
  /// Messages for the user since the last call, one line each.
  [[nodiscard]] virtual std::vector<std::string> messages() = 0;
};

}  // namespace proleg::optimize
