#include "host/server/web_server.hpp"

#include <utility>

#include "host/server/session_link.hpp"
#include "host/server/socket_server.hpp"

namespace proleg::host {

WebServer::WebServer(boost::asio::io_context& context, ServerOptions options, RobotSession& session)
    : link_(std::make_shared<SessionLink>(
          std::move(options.token), std::move(options.page), options.history_bytes,
          ViewerHub::Options{std::move(options.program), std::move(options.free_operations)}, session)),
      sockets_(std::make_shared<SocketServer>(context, options.port, std::move(options.certificate), link_)) {
  sockets_->accept();
}

WebServer::~WebServer() { stop(); }

std::uint16_t WebServer::port() const { return sockets_->address().port; }

std::string WebServer::origin() const { return first_origin(sockets_->address()); }

void WebServer::stop() { sockets_->post_stop(); }

void WebServer::wake() {
  if (link_->inbox.claim_wake()) {
    sockets_->post_delivery();
  }
}

void WebServer::publish(const std::string& name, const nlohmann::json& value) {
  link_->inbox.put_document(name, value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  wake();
}

void WebServer::set_signals(const SignalLayout& layout, std::uint32_t tick_us) {
  const std::uint64_t generation = link_->history.reset(layout.row_size());
  link_->inbox.put_layout({layout, tick_us, generation});
  wake();
}

void WebServer::add_row(std::uint16_t run, std::uint32_t tick, std::span<const std::int32_t> row) {
  link_->history.add(run, tick, row);
  wake();
}

void WebServer::answer(RequestId request, const nlohmann::json& value) {
  link_->inbox.put_answer({request, true, value, {}});
  wake();
}

void WebServer::refuse(RequestId request, const std::string& error) {
  link_->inbox.put_answer({request, false, nullptr, error});
  wake();
}

void WebServer::stopped(RequestId request, unsigned confirmed, unsigned of, double ms) {
  link_->inbox.put_stopped({request, confirmed, of, ms});
  wake();
}

void WebServer::notice(NoticeLevel level, const std::string& text) {
  link_->inbox.put_notice(level, text);
  wake();
}

}  // namespace proleg::host
