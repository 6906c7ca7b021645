#pragma once

// Simulations on several cores of this process.

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::python {

/// Runs the parts of some work in threads.
class WorkerThreads {
 public:
  /// Works from `first` to before `end`, and ends early when `stop` is true.
  using Work = std::function<void(std::size_t first, std::size_t end, const std::atomic<bool>& stop)>;

  /// scenario: what is simulated; it decides how large a part is. count: of all work, above 0.
  /// workers: threads, at least 1.
  WorkerThreads(const sim::Scenario& scenario, std::size_t count, std::size_t workers, Work work);
  ~WorkerThreads();  ///< stops them
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  /// Waits until all is done; without the lock of the interpreter. Throws what a thread threw, or what a signal handler
  /// of Python raised.
  void wait();

 private:
  void work();

  std::size_t count_;
  std::size_t part_;
  Work work_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable done_;
  std::size_t working_;
  std::exception_ptr thrown_;
  std::vector<std::thread> threads_;
};

}  // namespace proleg::python
