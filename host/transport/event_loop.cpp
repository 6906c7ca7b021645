#include "host/transport/event_loop.hpp"

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>

namespace proleg::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Microseconds longest_wait = 3'600'000'000;  // microseconds; a time point of `never` would overflow

Clock::time_point time_point_of(Microseconds time) {
  return Clock::time_point(std::chrono::duration_cast<Clock::duration>(std::chrono::microseconds(time)));
}

}  // namespace

using boost::asio::posix::stream_descriptor;

/// The handlers own this, so that one that is under way when the watch has gone finds no function.
class DescriptorWatch::Events : public std::enable_shared_from_this<DescriptorWatch::Events> {
 public:
  Events(boost::asio::io_context& context, int descriptor, std::function<void()> function)
      : descriptor_(context.get_executor(), descriptor), function_(std::move(function)) {}

  void wait() {
    descriptor_.async_wait(stream_descriptor::wait_read,
                           [self = shared_from_this()](const boost::system::error_code& error) {
                             if (!error) {
                               self->call();
                             }
                           });
  }
  void stop() {
    is_stopped_ = true;
    static_cast<void>(descriptor_.release());
  }

 private:
  void call() {
    if (!is_stopped_) {
      function_();
    }
    if (!is_stopped_) {
      wait();
    }
  }

  stream_descriptor descriptor_;
  const std::function<void()> function_;
  bool is_stopped_ = false;
};

DescriptorWatch::DescriptorWatch(boost::asio::io_context& context, int descriptor, std::function<void()> function)
    : events_(std::make_shared<Events>(context, descriptor, std::move(function))) {
  events_->wait();
}

DescriptorWatch::~DescriptorWatch() { events_->stop(); }

Microseconds steady_now() {
  const auto since_start = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch());
  return static_cast<Microseconds>(since_start.count());
}

void run_until(boost::asio::io_context& context, Microseconds deadline, const bool& is_done) {
  // Without work the context would stop, and the loop would not wait.
  const boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work(context.get_executor());
  context.restart();
  while (!is_done && context.poll_one() > 0) {
  }
  for (Microseconds now = steady_now(); !is_done && now < deadline; now = steady_now()) {
    context.run_one_until(time_point_of(std::min(deadline, now + longest_wait)));
    if (context.stopped()) {
      return;  // the program is being ended
    }
  }
}

class Timer::Events : public std::enable_shared_from_this<Timer::Events> {
 public:
  Events(boost::asio::io_context& context, std::function<void()> function)
      : timer_(context.get_executor()), function_(std::move(function)) {}

  void set(Microseconds time) {
    if (time == time_) {
      return;
    }
    time_ = time;
    timer_.cancel();
    if (time == never) {
      return;
    }
    timer_.expires_at(time_point_of(std::min(time, steady_now() + longest_wait)));
    timer_.async_wait([self = shared_from_this(), time](const boost::system::error_code& error) {
      // A handler that is under way is too late to be cancelled: it finds another time.
      if (!error && self->time_ == time) {
        self->time_ = never;
        self->function_();
      }
    });
  }

 private:
  boost::asio::steady_timer timer_;
  std::function<void()> function_;
  Microseconds time_ = never;
};

Timer::Timer(boost::asio::io_context& context, std::function<void()> function)
    : events_(std::make_shared<Events>(context, std::move(function))) {}

Timer::~Timer() { events_->set(never); }

void Timer::set(Microseconds time) { events_->set(time); }

}  // namespace proleg::host
