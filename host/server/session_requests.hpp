#pragma once

// What viewers ask of a session, on its way from the server's thread to that of the session.

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
    bool is_there = false;  ///< somebody drives
    bool is_away = false;   ///< but their page does not answer
  };

  // For any thread.
  void operate(const OperationRequest& request) override;
  void stop(const StopRequest& request) override;
  void holder_changed(bool has_holder, bool is_away) override;
  /// The session is to end.
  void end();

  // For the session's thread.

  /// All STOPs that wait. If there are any, the operations that wait as well go into `outdated`: what was asked for
  /// before a STOP has no effect after it.
  [[nodiscard]] std::vector<Stop> take_stops(std::deque<OperationRequest>& outdated);
  /// The oldest operation; nothing as long as a STOP waits.
  [[nodiscard]] std::optional<OperationRequest> take_operation();
  /// Who drives now.
  [[nodiscard]] Holder take_holder();
  /// Whether the session must interrupt what it does: a STOP waits, or it is to end.
  [[nodiscard]] bool interrupts() const;
  [[nodiscard]] bool ends() const;
  /// Whether something has come that was not taken. Costs nothing.
  [[nodiscard]] bool are_there() const { return are_there_; }
  /// Returns when something has come that was not taken, or at this time.
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
