#pragma once

// What the sessions behind the page have in common: a thread that does what viewers ask for, and outlives its errors.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>
#include <vector>

#include "host/server/robot_session.hpp"
#include "host/server/session_requests.hpp"

namespace proleg::tools {

class SessionThread {
 public:
  SessionThread(const SessionThread&) = delete;
  SessionThread& operator=(const SessionThread&) = delete;

 protected:
  using Clock = std::chrono::steady_clock;
  using Stops = std::vector<host::SessionRequests::Stop>;

  /// requests, output: must outlive this.
  SessionThread(host::SessionRequests& requests, host::SessionOutput& output) : requests_(requests), output_(output) {}
  virtual ~SessionThread() = default;

  /// The last call of the constructor of a session.
  void begin_thread();
  /// The first call of its destructor.
  void end_thread();

  // The thread calls these functions.

  /// Does what is to be done now, or waits for it: again and again until the session ends.
  virtual void serve() = 0;
  /// serve() has thrown this error, which viewers have been told: nothing moves any more.
  virtual void fail(const std::string& why) = 0;
  /// The session ends.
  virtual void close() {}
  /// Returns the value of the answer, or throws the refusal.
  [[nodiscard]] virtual nlohmann::json carry_out(const host::OperationRequest& operation) = 0;

  /// All STOPs that wait. What was asked for before one of them is refused.
  [[nodiscard]] Stops take_stops();
  /// Carries out all operations that wait, and answers them. Returns whether there were any.
  bool take_operations();

  host::SessionRequests& requests_;
  host::SessionOutput& output_;

 private:
  void run();
  void report(const std::string& error);

  std::string last_error_;  ///< of serve(); empty if it has thrown none the last time
  std::thread thread_;
};

}  // namespace proleg::tools
