#pragma once

// A robot behind a server: what the server asks of its session, and what the session reports.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "host/server/telemetry.hpp"

namespace proleg::host {

/// Number of a viewer, from 1; a server uses no number twice.
using ClientId = std::uint32_t;

/// Time since any fixed moment, on a steady clock. The state machines of the server receive it as an argument.
using ServerTime = std::chrono::milliseconds;
inline constexpr ServerTime no_deadline = ServerTime::max();

enum class NoticeLevel { info, warning, error };

/// Number of a request to the session, from 1; a server uses no number twice.
using RequestId = std::uint64_t;

struct OperationRequest {
  RequestId request = 0;
  std::string name;
  nlohmann::json arguments;  ///< an object, at most 16 levels deep
  ClientId client = 0;
  std::string client_name;
};

/// Answers to so many STOPs are waited for. Of more the oldest are forgotten: each of them stops the whole robot.
inline constexpr std::size_t max_pending_stops = 1024;

struct StopRequest {
  RequestId request = 0;
  std::string by;  ///< name of the viewer, or "POST /stop"
};

/// The robot that a server serves, in another thread. The server calls these functions in its own thread, so they pass
/// the request on and return at once.
class RobotSession {
 public:
  virtual ~RobotSession() = default;

  /// Receives an operation of a viewer that may use it. Its name may be unknown. The session answers it once, with
  /// WebServer::answer().
  virtual void operate(const OperationRequest& request) = 0;
  /// Stops the robot, whatever else is pending. The answer is WebServer::stopped(). A viewer may send many of these
  /// requests.
  virtual void stop(const StopRequest& request) = 0;
  /// Reports that a viewer drives now, that none does, or that the holder of control is away or back.
  virtual void holder_changed(bool has_holder, bool is_away) = 0;
};

/// Receives the output of a session for its viewers (docs/page-interface.md). Any thread may call these functions;
/// none of them waits.
class SessionOutput {
 public:
  /// Publishes a new revision of a document. The server makes the documents `control` and `telemetry` itself.
  virtual void publish(const std::string& document, const nlohmann::json& value) = 0;
  /// Sets the layout of later rows, and forgets earlier rows. tick_us: duration of a tick in microseconds. Must be
  /// called by the thread that calls add_row().
  virtual void set_signals(const SignalLayout& layout, std::uint32_t tick_us) = 0;
  /// Adds the values of all signals of a tick. Ticks of a run follow one another; two runs in a row have different
  /// numbers. Throws std::invalid_argument if the row does not have the layout's size.
  virtual void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) = 0;
  /// Reports that the operation had its effect. `value`: the result for the viewer. Bytes (json::binary) are sent as a
  /// binary message.
  virtual void answer(RequestId request, const nlohmann::json& value) = 0;
  /// Reports with one line that the operation was refused.
  virtual void refuse(RequestId request, const std::string& error) = 0;
  /// Reports that STOP has had its effect in `confirmed` of `of` modules, `ms` after the request.
  virtual void stopped(RequestId request, unsigned confirmed, unsigned of, double ms) = 0;
  /// Sends one line to all viewers.
  virtual void notice(NoticeLevel level, const std::string& text) = 0;

 protected:
  ~SessionOutput() = default;
};

}  // namespace proleg::host
