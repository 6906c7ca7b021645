#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "host/transport/descriptor.hpp"

namespace proleg::tools {

/// How a bus is used that this program has open: the robot of a session has power, or a job of another program goes on,
/// not both. Any thread may use it.
class BusSharing {
 public:
  /// Whether a job may begin now; then it has begun.
  [[nodiscard]] bool begin_job() {
    const std::lock_guard lock(mutex_);
    return !has_power_ && !std::exchange(has_job_, true);
  }
  void end_job() {
    const std::lock_guard lock(mutex_);
    has_job_ = false;
  }
  [[nodiscard]] bool has_job() const {
    const std::lock_guard lock(mutex_);
    return has_job_;
  }
  /// Whether servos may get power now; then they are about to.
  [[nodiscard]] bool begin_power() {
    const std::lock_guard lock(mutex_);
    return !has_job_ && !std::exchange(has_power_, true);
  }
  void end_power() {
    const std::lock_guard lock(mutex_);
    has_power_ = false;
  }

  /// Lets a program take part in the bus (host::SharedBus::add()).
  void add_program(host::Descriptor end) {
    const std::lock_guard lock(mutex_);
    programs_.push_back(std::move(end));
  }
  /// For the session that has the bus open: the programs that have come since the last call.
  [[nodiscard]] std::vector<host::Descriptor> take_programs() {
    const std::lock_guard lock(mutex_);
    return std::exchange(programs_, {});
  }

 private:
  mutable std::mutex mutex_;
  bool has_job_ = false;
  bool has_power_ = false;
  std::vector<host::Descriptor> programs_;
};

}  // namespace proleg::tools
