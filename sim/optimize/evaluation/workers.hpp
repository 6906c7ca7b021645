#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// Those who simulate, in other processes. Each has at most one task at a time.
class Workers {
 public:
  struct Done {
    std::uint64_t ticket;
    TrialResult result;
    std::uint32_t worker;
  };

  virtual ~Workers() = default;
  [[nodiscard]] virtual std::uint32_t count() const = 0;
  /// Those without a task.
  [[nodiscard]] virtual std::uint32_t idle() const = 0;
  /// Gives an idle worker a task. ticket: what wait() is to call it.
  virtual void start(std::uint64_t ticket, const Task& task) = 0;
  /// The next result, or nothing after the timeout. A worker that dies or hangs is replaced and its task done again;
  /// messages() tells. Throws std::runtime_error if a task killed three workers, or no worker is left.
  [[nodiscard]] virtual std::optional<Done> wait(std::chrono::milliseconds timeout) = 0;
  /// What a person should know since the last call, one line each.
  [[nodiscard]] virtual std::vector<std::string> messages() = 0;
};

}  // namespace proleg::optimize
