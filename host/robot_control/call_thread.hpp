#pragma once

#include <chrono>
#include <functional>
#include <memory>

namespace proleg::host {

/// Runs calls one after the other in a thread of its own, and gives up a call that does not return.
class CallThread {
 public:
  CallThread();
  /// Waits for nothing: the thread ends by itself, after a call that was given up too if that ever returns.
  ~CallThread();
  CallThread(const CallThread&) = delete;
  CallThread& operator=(const CallThread&) = delete;

  /// Runs a call and waits for its end. Returns false if it has not ended after the timeout, and then for all later
  /// calls, which do not run. The call must own what it uses: it may still run. It must not throw.
  [[nodiscard]] bool run(std::function<void()> call, std::chrono::microseconds timeout);
  /// Whether a call did not return.
  [[nodiscard]] bool is_lost() const { return is_lost_; }

 private:
  struct Shared;

  std::shared_ptr<Shared> shared_;
  bool is_lost_ = false;
};

}  // namespace proleg::host
