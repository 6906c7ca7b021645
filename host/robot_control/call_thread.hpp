#pragma once

#include <chrono>
#include <functional>
#include <memory>

namespace proleg::host {

/// Runs calls one after the other in a thread of its own, and abandons a call that does not return.
class CallThread {
 public:
  CallThread();
  /// Does not wait: the thread ends by itself, also after an abandoned call, if that ever returns.
  ~CallThread();
  CallThread(const CallThread&) = delete;
  CallThread& operator=(const CallThread&) = delete;

  /// Runs a call and waits for its end. Returns false if it has not ended after the timeout, and then for all later
  /// calls, which do not run. The call must own what it uses: it may still run. It must not throw.
  [[nodiscard]] bool run(std::function<void()> call, std::chrono::microseconds timeout);
  /// Whether a call was abandoned because it did not return in time.
  [[nodiscard]] bool is_lost() const { return is_lost_; }

 private:
  struct Shared;

  std::shared_ptr<Shared> shared_;
  bool is_lost_ = false;
};

}  // namespace proleg::host
