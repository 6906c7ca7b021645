#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "host/server/server_types.hpp"

namespace proleg::host {

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

}  // namespace proleg::host
