#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "host/server/connection.hpp"
#include "host/server/server_certificate.hpp"
#include "host/server/server_types.hpp"
#include "host/server/session_link.hpp"

namespace proleg::host {

/// Accepts connections, and wakes them when there is output. Connections share this object.
class SocketServer final : public ConnectionServer, public std::enable_shared_from_this<SocketServer> {
 public:
  SocketServer(boost::asio::io_context& context, std::uint16_t port,
               std::shared_ptr<const ServerCertificate> certificate, std::shared_ptr<SessionLink> link);

  void accept();
  /// Schedules the delivery of the session's output. May be called from any thread.
  void post_delivery();
  void post_stop();

  [[nodiscard]] const ServerAddress& address() const override { return address_; }
  [[nodiscard]] boost::asio::io_context& context() override { return context_; }
  [[nodiscard]] SessionLink& link() override { return *link_; }
  void add(const std::shared_ptr<Connection>& connection) override { connections_.push_back(connection); }
  void serve() override;

 private:
  using Connections = std::deque<std::weak_ptr<Connection>>;

  void listen(std::uint16_t port);
  void accepted(boost::asio::ip::tcp::socket socket);
  void stop();
  /// The connections that have not ended; the others are removed from the list.
  [[nodiscard]] static std::vector<std::shared_ptr<Connection>> living(Connections& connections);

  boost::asio::io_context& context_;
  const std::shared_ptr<const ServerCertificate> certificate_;
  const std::shared_ptr<SessionLink> link_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer timer_;
  boost::asio::steady_timer accept_timer_;
  ServerTime timer_deadline_ = no_deadline;
  ServerAddress address_;
  bool has_ended_ = false;
  Connections connections_;
  Connections stop_connections_;  ///< connections reserved for POST /stop, the oldest first
};

}  // namespace proleg::host
