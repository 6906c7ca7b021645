#include "tools/python/module/worker_threads.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim/loop/simulation_batch.hpp"
#include "tools/python/module/long_call.hpp"

namespace proleg::python {
namespace {

/// As many as the engine steps together, and few enough for all workers to have some.
std::size_t part_size(const sim::Scenario& scenario, std::size_t count, std::size_t workers) {
  constexpr std::size_t lanes = 8;  // of the widest kernel; a part should fill them
  const std::size_t most = sim::batch_size(scenario);
  if (most == 1) {
    return 1;
  }
  const std::size_t share = (count + workers - 1) / workers;
  return std::clamp((share + lanes - 1) / lanes * lanes, lanes, most);
}

}  // namespace

WorkerThreads::WorkerThreads(const sim::Scenario& scenario, std::size_t count, std::size_t workers, Work work)
    : count_(count),
      part_(part_size(scenario, count, workers)),
      work_(std::move(work)),
      working_(std::min(workers, count)) {
  for (std::size_t i = 0; i < std::min(workers, count); ++i) {
    threads_.emplace_back([this] { this->work(); });
  }
}

WorkerThreads::~WorkerThreads() {
  stop_ = true;
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

void WorkerThreads::wait() {
  SignalWatch watch;
  std::unique_lock lock(mutex_);
  while (!done_.wait_for(lock, std::chrono::milliseconds(50), [this] { return working_ == 0; })) {
    lock.unlock();
    watch.check();
    lock.lock();
  }
  if (thrown_) {
    std::rethrow_exception(thrown_);
  }
}

void WorkerThreads::work() {
  try {
    while (!stop_) {
      const std::size_t first = next_.fetch_add(part_);
      if (first >= count_) {
        break;
      }
      work_(first, std::min(first + part_, count_), stop_);
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    thrown_ = thrown_ ? thrown_ : std::current_exception();
    stop_ = true;
  }
  const std::lock_guard lock(mutex_);
  --working_;
  done_.notify_one();
}

}  // namespace proleg::python
