#include "tools/proleg/ui/session_base.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <deque>
#include <exception>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {

void SessionThread::begin_thread() {
  thread_ = std::thread([this] { run(); });
}

void SessionThread::end_thread() {
  requests_.end();
  thread_.join();
}

/// An error that left the thread would end the program, and leave a robot with power behind.
void SessionThread::run() {
  constexpr std::chrono::milliseconds pause_after_error{20};
  while (!requests_.ends()) {
    try {
      serve();
      last_error_.clear();
    } catch (const std::exception& error) {
      const std::string why = one_line(error.what());
      report(why);
      try {
        fail(why);
      } catch (const std::exception& second) {
        report(one_line(second.what()));
      }
      std::this_thread::sleep_for(pause_after_error);  // an error that stays does not take the processor
    }
  }
  try {
    close();
  } catch (const std::exception& error) {
    report(one_line(error.what()));
  }
}

/// An error that stays is reported once.
void SessionThread::report(const std::string& error) {
  if (error != last_error_) {
    output_.notice(host::NoticeLevel::error, error);
    last_error_ = error;
  }
}

SessionThread::Stops SessionThread::take_stops() {
  std::deque<host::OperationRequest> outdated;
  Stops stops = requests_.take_stops(outdated);
  for (const host::OperationRequest& operation : outdated) {
    output_.refuse(operation.request, "STOP came first");
  }
  return stops;
}

bool SessionThread::take_operations() {
  bool is_any = false;
  while (const std::optional<host::OperationRequest> operation = requests_.take_operation()) {
    is_any = true;
    try {
      output_.answer(operation->request, carry_out(*operation));
    } catch (const std::exception& error) {
      output_.refuse(operation->request, one_line(error.what()));
    }
  }
  return is_any;
}

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
