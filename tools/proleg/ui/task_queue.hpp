#pragma once

#include <functional>
#include <mutex>
#include <vector>

#include "host/transport/descriptor.hpp"

namespace proleg::tools {

/// What other threads give a thread to do that waits for descriptors.
class TaskQueue {
 public:
  /// Throws std::system_error if the system has no descriptors left.
  TaskQueue();

  /// From any thread.
  void post(std::function<void()> task);
  /// Can be read when there is something to do.
  [[nodiscard]] int descriptor() const { return event_.number(); }
  /// Does it, in order. If a task throws, the later ones wait for the next call.
  void run();

 private:
  host::Descriptor event_;
  std::mutex mutex_;
  std::vector<std::function<void()>> tasks_;
};

}  // namespace proleg::tools
