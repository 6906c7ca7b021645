#pragma once

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>

#include "host/server/access_token.hpp"
#include "host/server/notice_log.hpp"
#include "host/server/page_files.hpp"
#include "host/server/robot_session.hpp"
#include "host/server/signal_layout.hpp"

namespace proleg::host {

class SocketServer;
struct SessionLink;

struct ServerOptions {
  AccessToken token;
  PageFiles page;
  std::string program;                    ///< name and version, for the welcome
  std::set<std::string> free_operations;  ///< operations that anybody may use; all others need control
  std::uint16_t port = 0;                 ///< 0: any free one
  std::size_t history_bytes = 4U << 20U;  ///< memory for rows that a viewer has not read
};

/// Serves the page of one session on 127.0.0.1 (docs/page-interface.md), in the thread that runs the io_context. The
/// session is in another one.
class WebServer {
 public:
  /// Listens at once. Throws std::runtime_error with one line, e.g. if the port is in use.
  WebServer(boost::asio::io_context& context, ServerOptions options, RobotSession& session);
  /// As stop(). The session is not called any more once the io_context has no handlers left.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;

  // From any thread; none of them waits for a viewer.

  /// A new revision of a document. `control` and `telemetry` are the server's own.
  void publish(const std::string& name, const nlohmann::json& value);
  /// From now on rows have this layout; the rows before are forgotten. tick_us: duration of a tick in microseconds.
  /// The thread that calls add_row() calls this.
  void set_signals(const SignalLayout& layout, std::uint32_t tick_us);
  /// The values of all signals of a tick. Ticks of a run follow one another; a run has another number than the one
  /// before it. Throws std::invalid_argument if the row does not have the layout's size.
  void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row);
  /// The operation had its effect. `value`: what the viewer gets.
  void answer(RequestId request, const nlohmann::json& value);
  /// The operation was refused, with one line.
  void refuse(RequestId request, const std::string& error);
  /// STOP has had its effect in `confirmed` of `of` modules, `ms` after the request.
  void stopped(RequestId request, unsigned confirmed, unsigned of, double ms);
  /// One line for all viewers.
  void notice(NoticeLevel level, const std::string& text);

  /// Ends all connections (close code 1001, then after 1 s by force) and takes no more. Then the server leaves no work
  /// in the io_context.
  void stop();

 private:
  /// The server's thread looks into the inbox and the history.
  void wake();

  std::shared_ptr<SessionLink> link_;
  std::unique_ptr<SocketServer> sockets_;
};

}  // namespace proleg::host
