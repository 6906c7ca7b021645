#pragma once

// Requests of viewers to a session, on their way from the server's thread to that of the session.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "host/server/robot_session.hpp"

namespace proleg::host {

class SessionRequests final : public RobotSession {
 public:
  using Clock = std::chrono::steady_clock;

  struct Stop {
    RequestId request = 0;
    std::string by;
    Clock::time_point since;
  };
  struct Holder {
    bool is_there = false;  ///< a viewer drives
    bool is_away = false;   ///< the page of the viewer that drives does not answer
  };

  // For any thread.
  void operate(const OperationRequest& request) override;
  void stop(const StopRequest& request) override;
  void holder_changed(bool has_holder, bool is_away) override;
  /// Requests the end of the session.
  void end();

  // For the session's thread.

  /// All STOPs that wait, at most max_pending_stops. If there are any, the operations that wait as well go into
  /// `outdated`: what was asked for before a STOP has no effect after it.
  [[nodiscard]] std::vector<Stop> take_stops(std::deque<OperationRequest>& outdated);
  /// Takes the oldest operation; nothing as long as a STOP waits.
  [[nodiscard]] std::optional<OperationRequest> take_operation();
  /// Takes the present state of the holder of control.
  [[nodiscard]] Holder take_holder();
  /// Whether the session must interrupt its work: a STOP waits, or the session is to end.
  [[nodiscard]] bool interrupts() const;
  [[nodiscard]] bool ends() const;
  /// Whether a request has not been taken. The call is cheap.
  [[nodiscard]] bool are_there() const { return are_there_; }
  /// Waits until a request has not been taken, or until this time.
  void wait_until(Clock::time_point time);
  void wait();

 private:
  void notify();
  void look();

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<OperationRequest> operations_;
  std::vector<Stop> stops_;
  Holder holder_;
  bool is_holder_new_ = false;
  bool ends_ = false;
  std::atomic<bool> are_there_ = false;
};

}  // namespace proleg::host
