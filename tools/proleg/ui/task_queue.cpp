#include "tools/proleg/ui/task_queue.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <iterator>
#include <system_error>
#include <utility>

namespace proleg::tools {

TaskQueue::TaskQueue() : event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!event_.is_open()) {
    throw std::system_error(errno, std::generic_category(), "eventfd");
  }
}

void TaskQueue::post(std::function<void()> task) {
  const std::lock_guard lock(mutex_);
  tasks_.push_back(std::move(task));
  // It fails only if the counter is full; then the descriptor can be read already.
  [[maybe_unused]] const int ignored = eventfd_write(event_.number(), 1);
}

void TaskQueue::run() {
  std::vector<std::function<void()>> tasks;
  {
    const std::lock_guard lock(mutex_);
    tasks.swap(tasks_);
    eventfd_t count = 0;
    [[maybe_unused]] const int ignored = eventfd_read(event_.number(), &count);
  }
  for (auto task = tasks.begin(); task != tasks.end(); ++task) {
    try {
      (*task)();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      tasks_.insert(tasks_.begin(), std::make_move_iterator(task + 1), std::make_move_iterator(tasks.end()));
      [[maybe_unused]] const int ignored = eventfd_write(event_.number(), 1);
      throw;
    }
  }
}

}  // namespace proleg::tools
