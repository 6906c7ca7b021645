#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>

#include "shared/can/can_port.hpp"

namespace proleg::host {

/// Microseconds on the system's steady clock (CLOCK_MONOTONIC).
[[nodiscard]] Microseconds steady_now();

/// Runs handlers until `is_done`, or until this time. Handlers that are ready run also if the time has passed.
void run_until(boost::asio::io_context& context, Microseconds deadline, const bool& is_done);

/// Calls a function at a time. The function may set or destroy the timer.
class Timer {
 public:
  Timer(boost::asio::io_context& context, std::function<void()> function);
  /// The function is not called any more.
  ~Timer();
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  /// Replaces an earlier time. `never` only cancels it.
  void set(Microseconds time);

 private:
  class Events;
  std::shared_ptr<Events> events_;
};

}  // namespace proleg::host
