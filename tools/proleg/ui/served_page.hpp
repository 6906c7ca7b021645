#pragma once

// The page of a session: what the server and the session tell each other.

#include <boost/asio/io_context.hpp>
#include <memory>

#include "host/server/web_server.hpp"
#include "tools/proleg/ui/session_output.hpp"
#include "tools/proleg/ui/simulated_session.hpp"

namespace proleg::tools {

class ServedPage final : private host::RobotSession, private SessionOutput {
 public:
  /// Listens at once; the simulation begins. scenario, losses: must outlive this. Throws as WebServer and
  /// SimulatedSession do.
  ServedPage(boost::asio::io_context& context, host::ServerOptions server, const sim::Scenario& scenario,
             const sim::Losses* losses, SimulatedSessionOptions session);
  ServedPage(const ServedPage&) = delete;
  ServedPage& operator=(const ServedPage&) = delete;

  [[nodiscard]] std::uint16_t port() const { return server_.port(); }
  /// Ends all connections.
  void stop() { server_.stop(); }

 private:
  // On the server's thread.
  void operate(const host::OperationRequest& request) override;
  void stop(const host::StopRequest& request) override;
  /// A simulation goes on without a driver.
  void holder_changed(bool /*has_holder*/, bool /*is_away*/) override {}

  // On the session's thread.
  void publish(const std::string& document, const nlohmann::json& value) override;
  void set_signals(const std::vector<Signal>& signals, std::uint32_t tick_us) override;
  void add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) override;
  void done(std::uint64_t request, const nlohmann::json& value) override;
  void refused(std::uint64_t request, const std::string& why) override;
  void stopped(std::uint64_t request, unsigned confirmed, unsigned joints, double milliseconds) override;
  void notice(NoticeLevel level, const std::string& text) override;

  host::WebServer server_;
  SimulatedSession session_;  ///< the first to end
};

}  // namespace proleg::tools
