#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>

#include "host/server/session_link.hpp"

namespace proleg::host {

/// The sockets of a web server: HTTP and WebSocket on 127.0.0.1. It runs in the io_context, and so does the hub.
class SocketServer {
 public:
  /// Listens at once. port 0: any free one. Throws std::runtime_error with one line.
  SocketServer(boost::asio::io_context& context, std::uint16_t port, std::shared_ptr<SessionLink> link);

  [[nodiscard]] std::uint16_t port() const;

  // From any thread.

  /// Has the link deliver what the session has said, and sends it.
  void post_delivery();
  /// Ends all connections and takes no more. The handlers that are left keep the link.
  void post_stop();

 private:
  class Service;

  std::shared_ptr<Service> service_;
};

}  // namespace proleg::host
