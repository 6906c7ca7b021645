#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <chrono>
#include <memory>
#include <string>

#include "host/server/request_policy.hpp"
#include "host/server/robot_session.hpp"
#include "host/server/seats.hpp"
#include "host/server/session_link.hpp"

namespace proleg::host {

/// A connection of a browser or program. It exists as long as one of its handlers.
class Connection {
 public:
  virtual ~Connection() = default;
  /// Sends the pending output, if nothing is being sent.
  virtual void pump() {}
  /// Ends the connection in an orderly way, if the other end permits it.
  virtual void end() = 0;
  virtual void end_by_force() = 0;
};

/// The functions of the server that its connections use. All connections share it.
class ConnectionServer {
 public:
  virtual ~ConnectionServer() = default;
  [[nodiscard]] virtual const ServerAddress& address() const = 0;
  [[nodiscard]] virtual boost::asio::io_context& context() = 0;
  [[nodiscard]] virtual SessionLink& link() = 0;
  /// The seats behind this server; null: there are none.
  [[nodiscard]] virtual SeatDirectory* seats() = 0;
  /// The computers that are connected to them.
  [[nodiscard]] virtual SeatVisitors& visitors() = 0;
  /// Adds a connection of this computer, which ends with this server.
  virtual void add(const std::shared_ptr<Connection>& connection, const std::string& address) = 0;
  /// Takes note of a request that was refused because of the way on which it came. line: for the person who runs the
  /// server.
  virtual void report_refusal(const std::string& line) = 0;
  /// Sends the pending output and waits for the next deadline. To be called after each event.
  virtual void serve() = 0;
};

[[nodiscard]] inline ServerTime server_now() {
  return std::chrono::duration_cast<ServerTime>(std::chrono::steady_clock::now().time_since_epoch());
}

enum class ConnectionUse { any, only_stop };

/// Opens a connection that handles requests one after the other, after the handshake of TLS if `tls` is not null. A
/// request for a WebSocket makes it a ViewerConnection. only_stop: it handles one request, and refuses any request
/// other than POST /stop with 503.
[[nodiscard]] std::shared_ptr<Connection> open_http_connection(std::shared_ptr<ConnectionServer> server,
                                                               boost::asio::ip::tcp::socket socket,
                                                               boost::asio::ssl::context* tls, ConnectionUse use);

}  // namespace proleg::host
