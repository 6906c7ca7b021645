#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <memory>

#include "host/server/request_policy.hpp"
#include "host/server/server_types.hpp"
#include "host/server/session_link.hpp"

namespace proleg::host {

/// A connection of a browser or program, for as long as one of its handlers exists.
class Connection {
 public:
  virtual ~Connection() = default;
  /// Sends what there is to send, if nothing is on its way.
  virtual void pump() {}
  /// Ends in an orderly way, if the other end lets it.
  virtual void end() = 0;
  virtual void end_by_force() = 0;
};

/// What connections use of the server that took them. They share it.
class ConnectionServer {
 public:
  virtual ~ConnectionServer() = default;
  [[nodiscard]] virtual const ServerAddress& address() const = 0;
  [[nodiscard]] virtual boost::asio::io_context& context() = 0;
  [[nodiscard]] virtual SessionLink& link() = 0;
  /// The connection ends with this service.
  virtual void add(const std::shared_ptr<Connection>& connection) = 0;
  /// After each event: sends what can be sent, and waits for the next deadline.
  virtual void serve() = 0;
};

[[nodiscard]] inline ServerTime server_now() {
  return std::chrono::duration_cast<ServerTime>(std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace proleg::host
