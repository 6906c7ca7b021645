#include "host/server/robot_session.hpp"

#include <utility>

namespace proleg::host {

void SessionRequests::operate(const OperationRequest& request) {
  const std::lock_guard lock(mutex_);
  operations_.push_back(request);
  notify();
}

void SessionRequests::stop(const StopRequest& request) {
  const std::lock_guard lock(mutex_);
  if (stops_.size() >= max_pending_stops) {
    stops_.erase(stops_.begin());
  }
  stops_.push_back({request.request, request.by, Clock::now()});
  notify();
}

void SessionRequests::holder_changed(bool has_holder, bool is_away) {
  const std::lock_guard lock(mutex_);
  holder_ = {has_holder, is_away};
  is_holder_new_ = true;
  notify();
}

void SessionRequests::end() {
  const std::lock_guard lock(mutex_);
  ends_ = true;
  notify();
}

std::vector<SessionRequests::Stop> SessionRequests::take_stops(std::deque<OperationRequest>& outdated) {
  const std::lock_guard lock(mutex_);
  if (!stops_.empty()) {
    outdated = std::exchange(operations_, {});
  }
  std::vector<Stop> stops = std::exchange(stops_, {});
  look();
  return stops;
}

std::optional<OperationRequest> SessionRequests::take_operation() {
  const std::lock_guard lock(mutex_);
  if (!stops_.empty() || operations_.empty()) {
    return std::nullopt;
  }
  OperationRequest operation = std::move(operations_.front());
  operations_.pop_front();
  look();
  return operation;
}

SessionRequests::Holder SessionRequests::take_holder() {
  const std::lock_guard lock(mutex_);
  is_holder_new_ = false;
  look();
  return holder_;
}

bool SessionRequests::interrupts() const {
  const std::lock_guard lock(mutex_);
  return ends_ || !stops_.empty();
}

bool SessionRequests::ends() const {
  const std::lock_guard lock(mutex_);
  return ends_;
}

void SessionRequests::wait_until(Clock::time_point time) {
  std::unique_lock lock(mutex_);
  wake_.wait_until(lock, time, [this] { return are_there_.load(); });
}

void SessionRequests::wait() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return are_there_.load(); });
}

void SessionRequests::notify() {
  are_there_ = true;
  wake_.notify_one();
}

/// Updates are_there_: whether any request is left.
void SessionRequests::look() { are_there_ = ends_ || is_holder_new_ || !stops_.empty() || !operations_.empty(); }

}  // namespace proleg::host
