#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

#include "host/transport/descriptor.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::tools {

/// How a bus is used that this program has open: the robot of a session has power, or a job of another program goes on,
/// not both. Any thread may use it.
class BusSharing {
 public:
  /// Whether a job may begin now; then it has begun. gives_way: it is to end when servos are to get power.
  /// longest_loss: time for which it goes on without the bus.
  [[nodiscard]] bool begin_job(std::chrono::seconds longest_loss, bool gives_way) {
    const std::lock_guard lock(mutex_);
    if (has_power_ || has_job_ || is_power_wanted_) {
      return false;
    }
    has_job_ = true;
    gives_way_ = gives_way;
    longest_loss_ = longest_loss;
    return true;
  }
  void end_job() {
    const std::lock_guard lock(mutex_);
    has_job_ = false;
    job_ended_.notify_all();
  }
  [[nodiscard]] bool has_job() const {
    const std::lock_guard lock(mutex_);
    return has_job_;
  }
  /// Whether the present job must end, because servos are to get power.
  [[nodiscard]] bool must_give_way() const {
    const std::lock_guard lock(mutex_);
    return has_job_ && is_power_wanted_;
  }
  /// Of the present job, in microseconds, or the last one.
  [[nodiscard]] Microseconds longest_loss() const {
    const std::lock_guard lock(mutex_);
    return static_cast<Microseconds>(std::chrono::microseconds(longest_loss_).count());
  }
  /// Whether servos may get power now; then they are about to. Waits for a moment until a job has given way.
  [[nodiscard]] bool begin_power() {
    constexpr std::chrono::milliseconds patience{500};
    std::unique_lock lock(mutex_);
    if (has_job_ && gives_way_) {
      is_power_wanted_ = true;
      job_ended_.wait_for(lock, patience, [this] { return !has_job_; });
      is_power_wanted_ = false;
    }
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
  std::condition_variable job_ended_;
  bool has_job_ = false;
  bool gives_way_ = false;
  bool is_power_wanted_ = false;
  std::chrono::seconds longest_loss_{0};
  bool has_power_ = false;
  std::vector<host::Descriptor> programs_;
};

}  // namespace proleg::tools
