#pragma once

// A method of `proleg optimise` that asks, and a caller that answers: the two ends of a rendezvous.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/workers.hpp"

namespace proleg::python {

/// Workers that simulate nothing: a caller in another thread takes the tasks and brings their results, in any time.
///
/// They take tasks only while the method waits for a result. Before, what it will ask next is a guess, which a result
/// may make wrong; and a task that was taken is a run that somebody makes.
class AskedWorkers final : public optimize::Workers {
 public:
  /// count: tasks that can be asked for at the same time, at least 1.
  explicit AskedWorkers(std::uint32_t count) : count_(count) {}

  // The end of the method.

  [[nodiscard]] std::uint32_t count() const override { return count_; }
  [[nodiscard]] std::uint32_t idle() const override;
  [[nodiscard]] std::size_t most_at_once() const override { return 1; }
  void start(std::span<const optimize::TicketedTask> batch) override;
  [[nodiscard]] std::optional<Done> wait(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::vector<std::string> messages() override { return {}; }
  /// No task follows.
  void end();

  // The end of the caller.

  /// Whether the method waits for results, or has ended, within the time.
  [[nodiscard]] bool wait_until_asked(std::chrono::milliseconds timeout);
  [[nodiscard]] bool has_ended() const;
  /// The first tasks without a result, at most `most`, in the order in which the method needs them.
  [[nodiscard]] std::vector<optimize::Task> tasks(std::size_t most) const;
  /// The results of the first tasks. There must be so many.
  void answer(std::vector<optimize::TrialResult> results);
  /// The method is to end: wait() returns at once from now on.
  void close();

 private:
  const std::uint32_t count_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<optimize::TicketedTask> tasks_;  ///< without a result
  std::deque<Done> done_;
  bool takes_ = false;     ///< the method waits, so it is given what it asks for
  bool is_asked_ = false;  ///< and it has been given that
  bool has_ended_ = false;
  bool is_closed_ = false;
};

}  // namespace proleg::python
