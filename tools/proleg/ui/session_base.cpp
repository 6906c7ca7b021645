#include "tools/proleg/ui/session_base.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {

void SessionRouter::operate(const host::OperationRequest& request) {
  const bool is_for_draft =
      std::ranges::any_of(std::array{draft_operations, world_operations, draft_robot_operations, behaviour_operations},
                          [&](std::string_view begin) { return request.name.starts_with(begin); });
  if (request.name.starts_with(recording_operations)) {
    recordings_.operate(request);
  } else if (is_for_draft) {
    draft_.operate(request);
  } else if (request.name.starts_with(mesh_operations)) {
    meshes_.operate(request);
  } else if (request.name.starts_with(gallery_operations)) {
    gallery_.operate(request);
  } else if (request.name.starts_with(algorithm_operations)) {
    algorithms_.operate(request);
  } else if (request.name.starts_with(search_operations)) {
    searches_.operate(request);
  } else if (request.name.starts_with(sweep_operations)) {
    sweeps_.operate(request);
  } else if (request.name.starts_with(module_operations)) {
    modules_.operate(request);
  } else if (request.name.starts_with(remote_operations)) {
    remote_.operate(request);
  } else {
    robot_.operate(request);
  }
}

void SessionRouter::stop(const host::StopRequest& request) {
  robot_.stop(request);
  modules_.stop(request);
  remote_.stop(request);
}

void SessionRouter::holder_changed(bool has_holder, bool is_away) {
  robot_.holder_changed(has_holder, is_away);
  modules_.holder_changed(has_holder, is_away);
  remote_.holder_changed(has_holder, is_away);
}

void SessionRequests::operate(const host::OperationRequest& request) {
  const std::lock_guard lock(mutex_);
  operations_.push_back(request);
  notify();
}

void SessionRequests::stop(const host::StopRequest& request) {
  const std::lock_guard lock(mutex_);
  if (stops_.size() >= host::max_pending_stops) {
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

std::vector<SessionRequests::Stop> SessionRequests::take_stops(std::deque<host::OperationRequest>& outdated) {
  const std::lock_guard lock(mutex_);
  if (!stops_.empty()) {
    outdated = std::exchange(operations_, {});
  }
  std::vector<Stop> stops = std::exchange(stops_, {});
  look();
  return stops;
}

std::optional<host::OperationRequest> SessionRequests::take_operation() {
  const std::lock_guard lock(mutex_);
  if (!stops_.empty() || operations_.empty()) {
    return std::nullopt;
  }
  host::OperationRequest operation = std::move(operations_.front());
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

void SessionThread::begin_thread() {
  thread_ = std::thread([this] { run(); });
}

void SessionThread::end_thread() {
  requests_.end();
  thread_.join();
}

/// An error that left the thread would end the program, and leave a robot with power behind.
void SessionThread::run() {
  constexpr std::chrono::milliseconds pause_after_error{20};
  while (!requests_.ends()) {
    try {
      serve();
      last_error_.clear();
    } catch (const std::exception& error) {
      const std::string why = one_line(error.what());
      report(why);
      try {
        fail(why);
      } catch (const std::exception& second) {
        report(one_line(second.what()));
      }
      std::this_thread::sleep_for(pause_after_error);  // an error that persists must not keep the processor busy
    }
  }
  try {
    close();
  } catch (const std::exception& error) {
    report(one_line(error.what()));
  }
  requests_.note_end();
}

/// An error that stays is reported once.
void SessionThread::report(const std::string& error) {
  if (error != last_error_) {
    output_.notice(host::NoticeLevel::error, error);
    last_error_ = error;
  }
}

SessionThread::Stops SessionThread::take_stops() {
  std::deque<host::OperationRequest> outdated;
  Stops stops = requests_.take_stops(outdated);
  for (const host::OperationRequest& operation : outdated) {
    output_.refuse(operation.request, "STOP came first");
  }
  return stops;
}

bool SessionThread::take_operations() {
  bool is_any = false;
  while (const std::optional<host::OperationRequest> operation = requests_.take_operation()) {
    is_any = true;
    try {
      if (const nlohmann::json value = carry_out(*operation); !value.is_discarded()) {
        output_.answer(operation->request, value);
      }
    } catch (const std::exception& error) {
      output_.refuse(operation->request, one_line(error.what()));
    }
  }
  return is_any;
}

}  // namespace proleg::tools
