#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "host/server/connection.hpp"
#include "host/server/page_files.hpp"
#include "host/server/request_policy.hpp"
#include "host/server/robot_session.hpp"
#include "host/server/seats.hpp"
#include "host/server/server_certificate.hpp"
#include "host/server/session_link.hpp"

namespace proleg::host {

/// Accepts connections, and wakes them when there is output. Connections share this object.
class SocketServer final : public ConnectionServer, public std::enable_shared_from_this<SocketServer> {
 public:
  SocketServer(boost::asio::io_context& context, std::uint16_t port,
               std::shared_ptr<const ServerCertificate> certificate, SeatDirectory* seats,
               std::shared_ptr<SessionLink> link, std::function<void(const std::string&)> refused);

  void accept();
  /// Schedules the delivery of the session's output. May be called from any thread.
  void post_delivery();
  void post_stop();
  /// Has the server's thread do something.
  void post(std::function<void()> task);

  [[nodiscard]] const ServerAddress& address() const override { return address_; }
  [[nodiscard]] boost::asio::io_context& context() override { return context_; }
  [[nodiscard]] SessionLink& link() override { return *link_; }
  [[nodiscard]] SeatDirectory* seats() override { return seats_; }
  [[nodiscard]] SeatVisitors& visitors() override { return visitors_; }
  void add(const std::shared_ptr<Connection>& connection, const std::string& address) override {
    connections_.push_back({connection, address});
  }
  void report_refusal(const std::string& line) override;
  void serve() override;

 private:
  struct Known {
    std::weak_ptr<Connection> connection;
    std::string address;
  };
  using Connections = std::deque<Known>;

  void listen(std::uint16_t port);
  void accepted(boost::asio::ip::tcp::socket socket);
  void stop();
  /// The connections that have not ended; the others are removed from the list.
  [[nodiscard]] static std::vector<std::shared_ptr<Connection>> living(Connections& connections);

  boost::asio::io_context& context_;
  const std::shared_ptr<const ServerCertificate> certificate_;
  SeatDirectory* const seats_;
  const std::shared_ptr<SessionLink> link_;
  const std::function<void(const std::string&)> refused_;
  ServerTime next_refusal_{};  ///< none is reported before
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer timer_;
  boost::asio::steady_timer accept_timer_;
  ServerTime timer_deadline_ = no_deadline;
  ServerAddress address_;
  bool has_ended_ = false;
  Connections connections_;
  SeatVisitors visitors_;
  Connections stop_connections_;  ///< connections reserved for POST /stop, the oldest first
};

class ServerCertificate;
class SocketServer;
struct SessionLink;

struct ServerOptions {
  AccessToken token;
  PageFiles page;
  std::string program;                    ///< name and version, for the welcome
  std::set<std::string> free_operations;  ///< operations that every viewer may use; all others need control
  std::uint16_t port = 0;                 ///< 0: any free port
  std::shared_ptr<const ServerCertificate> certificate{};  ///< all interfaces, TLS only; null: 127.0.0.1, no TLS
  std::size_t history_bytes = 4U << 20U;                   ///< memory for rows that a viewer has not read
  /// Programs behind this server, which must outlive the io_context; "/" is then class.html. Null: there are none.
  SeatDirectory* seats = nullptr;
  bool is_seat = false;  ///< this is such a program
  /// Gets a line about a request that was refused for its Host or Origin: at most one in ten seconds. For the terminal.
  std::function<void(const std::string& line)> refused{};
  DocumentFiles documents{};
};

/// Serves the page of one session (docs/page-interface.md), in the thread that runs the io_context. The session is in
/// another thread.
class WebServer final : public SessionOutput {
 public:
  /// Listens at once. Throws std::runtime_error with one line, for example if the port is in use.
  WebServer(boost::asio::io_context& context, ServerOptions options, RobotSession& session);
  /// Calls stop(). The session is not called any more once the io_context has no handlers left.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// The address of the page: "http://127.0.0.1:8123", or with the first name of the certificate and https.
  [[nodiscard]] std::string origin() const;

  void publish(const std::string& document, const nlohmann::json& value) override;
  void set_signals(const SignalLayout& layout, std::uint32_t tick_us) override;
  void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) override;
  void answer(RequestId request, const nlohmann::json& value) override;
  void refuse(RequestId request, const std::string& error) override;
  void stopped(RequestId request, unsigned confirmed, unsigned of, double ms) override;
  void notice(NoticeLevel level, const std::string& text) override;

  /// Pages that are connected now. For the thread that runs the io_context.
  [[nodiscard]] std::size_t viewers() const;
  /// Stops the robot, as POST /stop does. answered: called in the server's thread with the modules that have confirmed
  /// it, and the number of all. May be called from any thread.
  void stop_robot(const std::string& by, std::function<void(unsigned confirmed, unsigned of)> answered);
  /// Ends all connections (close code 1001, then after 1 s by force) and accepts no more. Then the server leaves no
  /// work in the io_context.
  void stop();

 private:
  /// Makes the server's thread read the inbox and the history.
  void wake();

  std::shared_ptr<SessionLink> link_;
  std::shared_ptr<SocketServer> sockets_;
};

}  // namespace proleg::host
