#include "tools/python/module/asked_workers.hpp"

#include <algorithm>
#include <utility>

namespace proleg::python {

std::uint32_t AskedWorkers::idle() const {
  const std::lock_guard lock(mutex_);
  return takes_ ? count_ - static_cast<std::uint32_t>(std::min<std::size_t>(count_, tasks_.size())) : 0;
}

void AskedWorkers::start(std::span<const optimize::TicketedTask> batch) {
  const std::lock_guard lock(mutex_);
  tasks_.insert(tasks_.end(), batch.begin(), batch.end());
}

std::optional<optimize::Workers::Done> AskedWorkers::wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  if (done_.empty() && timeout > std::chrono::milliseconds(0)) {
    if (!std::exchange(takes_, true)) {
      return std::nullopt;  // the method comes again, and has its tasks taken before
    }
    is_asked_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, timeout, [this] { return !done_.empty() || is_closed_; });
  } else {
    takes_ = false;
  }
  if (done_.empty()) {
    return std::nullopt;
  }
  takes_ = false;
  Done done = std::move(done_.front());
  done_.pop_front();
  return done;
}

void AskedWorkers::end() {
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  changed_.notify_all();
}

bool AskedWorkers::wait_until_asked(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [this] { return is_asked_ || has_ended_; });
}

bool AskedWorkers::has_ended() const {
  const std::lock_guard lock(mutex_);
  return has_ended_;
}

std::vector<optimize::Task> AskedWorkers::tasks(std::size_t most) const {
  const std::lock_guard lock(mutex_);
  std::vector<optimize::Task> tasks;
  for (std::size_t i = 0; i < std::min(most, tasks_.size()); ++i) {
    tasks.push_back(tasks_[i].task);
  }
  return tasks;
}

void AskedWorkers::answer(std::vector<optimize::TrialResult> results) {
  const std::lock_guard lock(mutex_);
  for (optimize::TrialResult& result : results) {
    done_.push_back({tasks_.front().ticket, std::move(result), 0});
    tasks_.pop_front();
  }
  is_asked_ = false;
  takes_ = false;  // what it would ask for next depends on these results
  changed_.notify_all();
}

void AskedWorkers::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  changed_.notify_all();
}

}  // namespace proleg::python
