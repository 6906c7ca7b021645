#include "host/robot_control/call_thread.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace proleg::host {

struct CallThread::Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::function<void()> call;  ///< the next call, or the one that runs
  bool is_running = false;
  bool must_end = false;
};

CallThread::CallThread() : shared_(std::make_shared<Shared>()) {
  std::thread([shared = shared_] {
    std::unique_lock lock(shared->mutex);
    for (;;) {
      shared->changed.wait(lock, [&] { return shared->call || shared->must_end; });
      if (!shared->call) {
        return;
      }
      lock.unlock();
      shared->call();
      lock.lock();
      shared->call = nullptr;  // objects that the call owns are destroyed here, in this thread
      shared->is_running = false;
      shared->changed.notify_all();
    }
  }).detach();
}

CallThread::~CallThread() {
  const std::lock_guard lock(shared_->mutex);
  shared_->must_end = true;
  shared_->changed.notify_all();
}

bool CallThread::run(std::function<void()> call, std::chrono::microseconds timeout) {
  if (is_lost_) {
    return false;
  }
  std::unique_lock lock(shared_->mutex);
  shared_->call = std::move(call);
  shared_->is_running = true;
  shared_->changed.notify_all();
  is_lost_ = !shared_->changed.wait_for(lock, timeout, [&] { return !shared_->is_running; });
  return !is_lost_;
}

}  // namespace proleg::host
