#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>

#include "shared/can/can_port.hpp"

namespace proleg::host {

/// Calls a function, from the io_context, as long as a descriptor can be read. The function may destroy the watch.
class DescriptorWatch {
 public:
  /// The descriptor stays open longer than the watch; its owner closes it.
  DescriptorWatch(boost::asio::io_context& context, int descriptor, std::function<void()> function);
  ~DescriptorWatch();
  DescriptorWatch(const DescriptorWatch&) = delete;
  DescriptorWatch& operator=(const DescriptorWatch&) = delete;

 private:
  class Events;
  std::shared_ptr<Events> events_;
};

/// The time of the system's steady clock (CLOCK_MONOTONIC) in microseconds.
[[nodiscard]] Microseconds steady_now();

/// Runs handlers until `is_done`, or until this time. Handlers that are ready run also if the time has passed.
void run_until(boost::asio::io_context& context, Microseconds deadline, const bool& is_done);

/// Calls a function at a time. The function may set or destroy the timer.
class Timer {
 public:
  Timer(boost::asio::io_context& context, std::function<void()> function);
  /// Cancels the call of the function.
  ~Timer();
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  /// Sets the time of the call, which replaces an earlier one. `never` only cancels the call.
  void set(Microseconds time);

 private:
  class Events;
  std::shared_ptr<Events> events_;
};

}  // namespace proleg::host
