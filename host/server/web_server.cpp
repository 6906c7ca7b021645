#include "host/server/web_server.hpp"

#include <algorithm>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "host/server/client_stream.hpp"
#include "host/server/connection.hpp"
#include "host/server/session_link.hpp"

namespace proleg::host {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using tcp = asio::ip::tcp;

constexpr std::size_t max_connections = 56;
// With seats. One computer can take only a part of them.
constexpr std::size_t max_class_connections = 600;
constexpr std::size_t max_connections_of_computer = 150;
constexpr std::size_t max_stop_connections = 8;
constexpr std::chrono::milliseconds accept_pause{100};

}  // namespace

SocketServer::SocketServer(asio::io_context& context, std::uint16_t port,
                           std::shared_ptr<const ServerCertificate> certificate, SeatDirectory* seats,
                           std::shared_ptr<SessionLink> link, std::function<void(const std::string&)> refused)
    : context_(context),
      certificate_(std::move(certificate)),
      seats_(seats),
      link_(std::move(link)),
      refused_(std::move(refused)),
      acceptor_(context),
      timer_(context),
      accept_timer_(context) {
  try {
    listen(port);
  } catch (const boost::system::system_error& error) {
    const std::string place = certificate_ ? "port " : "127.0.0.1:";
    throw std::runtime_error(place + std::to_string(port) + ": found " + error.code().message() +
                             ", expected a free port");
  }
}

void SocketServer::listen(std::uint16_t port) {
  tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
  if (certificate_) {
    // The server listens on all interfaces; the IPv6 socket also takes IPv4, if the system has IPv6.
    error_code error;
    acceptor_.open(tcp::v6(), error);
    if (!error) {
      acceptor_.set_option(asio::ip::v6_only(false));
    }
    endpoint = tcp::endpoint(error ? tcp::v4() : tcp::v6(), port);
  }
  if (!acceptor_.is_open()) {
    acceptor_.open(endpoint.protocol());
  }
  acceptor_.set_option(asio::socket_base::reuse_address(true));
  acceptor_.bind(endpoint);
  acceptor_.listen();
  address_ = {acceptor_.local_endpoint().port(), certificate_ != nullptr,
              certificate_ ? certificate_->names() : std::vector<std::string>(),
              certificate_ ? certificate_->wildcards() : std::vector<std::string>()};
}

void SocketServer::report_refusal(const std::string& line) {
  constexpr std::chrono::seconds period{10};  // anybody can have a request refused
  if (refused_ && server_now() >= next_refusal_) {
    next_refusal_ = server_now() + period;
    refused_(line);
  }
}

void SocketServer::post_delivery() {
  asio::post(context_, [self = shared_from_this()] {
    self->link_->deliver();
    self->serve();
  });
}

void SocketServer::post(std::function<void()> task) { asio::post(context_, std::move(task)); }

void SocketServer::post_stop() {
  asio::post(context_, [self = shared_from_this()] { self->stop(); });
}

void SocketServer::accept() {
  acceptor_.async_accept([self = shared_from_this()](const error_code& error, tcp::socket socket) {
    if (self->has_ended_) {
      return;
    }
    if (!error) {
      self->accepted(std::move(socket));
      self->accept();
      return;
    }
    // The process may have no file descriptors left; another attempt at once would fail, too.
    self->accept_timer_.expires_after(accept_pause);
    self->accept_timer_.async_wait([self](const error_code&) {
      if (!self->has_ended_) {
        self->accept();
      }
    });
  });
}

void SocketServer::accepted(tcp::socket socket) {
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  asio::ssl::context* const tls = certificate_ ? &certificate_->tls() : nullptr;
  const std::string address = address_of(socket);
  const std::size_t open = living(connections_).size();
  const auto open_of_computer = static_cast<std::size_t>(std::ranges::count(connections_, address, &Known::address));
  if (seats_ == nullptr ? open < max_connections
                        : open < max_class_connections && open_of_computer < max_connections_of_computer) {
    add(open_http_connection(shared_from_this(), std::move(socket), tls, ConnectionUse::any), address);
    return;
  }
  if (const auto reserved = living(stop_connections_); reserved.size() >= max_stop_connections) {
    reserved.front()->end_by_force();
    stop_connections_.pop_front();
  }
  stop_connections_.push_back(
      {open_http_connection(shared_from_this(), std::move(socket), tls, ConnectionUse::only_stop), address});
}

std::vector<std::shared_ptr<Connection>> SocketServer::living(Connections& connections) {
  std::vector<std::shared_ptr<Connection>> living;
  std::erase_if(connections, [&living](const Known& known) {
    if (std::shared_ptr<Connection> connection = known.connection.lock()) {
      living.push_back(std::move(connection));
      return false;
    }
    return true;
  });
  return living;
}

void SocketServer::serve() {
  const ServerTime now = server_now();
  link_->hub.advance(now);
  for (const std::shared_ptr<Connection>& connection : living(connections_)) {
    connection->pump();
  }
  const ServerTime deadline = has_ended_ ? no_deadline : link_->hub.deadline(now);
  if (deadline == timer_deadline_) {
    return;
  }
  timer_deadline_ = deadline;
  timer_.cancel();
  if (deadline == no_deadline) {
    return;
  }
  timer_.expires_at(std::chrono::steady_clock::time_point(deadline));
  timer_.async_wait([self = shared_from_this(), deadline](const error_code& error) {
    if (!error && self->timer_deadline_ == deadline) {
      self->timer_deadline_ = no_deadline;
      self->serve();
    }
  });
}

void SocketServer::stop() {
  if (std::exchange(has_ended_, true)) {
    return;
  }
  error_code ignored;
  acceptor_.close(ignored);
  accept_timer_.cancel();
  timer_.cancel();
  for (Connections* const connections : {&connections_, &stop_connections_}) {
    for (const std::shared_ptr<Connection>& connection : living(*connections)) {
      connection->end();
    }
  }
}

namespace {

/// Of computers in the network, none has control before a person there asks for it. A seat has one learner.
NewViewers first_control(bool is_open_to_network, bool is_seat) {
  if (is_seat) {
    return NewViewers::any;
  }
  return is_open_to_network ? NewViewers::none : NewViewers::alone;
}

}  // namespace

WebServer::WebServer(boost::asio::io_context& context, ServerOptions options, RobotSession& session)
    : link_(std::make_shared<SessionLink>(
          std::move(options.token), std::move(options.page), std::move(options.documents), options.history_bytes,
          ViewerHub::Options{std::move(options.program), std::move(options.free_operations),
                             first_control(options.certificate != nullptr, options.is_seat)},
          session)),
      sockets_(std::make_shared<SocketServer>(context, options.port, std::move(options.certificate), options.seats,
                                              link_, std::move(options.refused))) {
  sockets_->accept();
}

WebServer::~WebServer() { stop(); }

std::uint16_t WebServer::port() const { return sockets_->address().port; }

std::size_t WebServer::viewers() const { return link_->hub.viewers(); }

std::string WebServer::origin() const { return first_origin(sockets_->address()); }

void WebServer::stop_robot(const std::string& by, std::function<void(unsigned, unsigned)> answered) {
  sockets_->post([link = link_, by, answered = std::move(answered)] {
    link->hub.stop(by, [answered](const StopAnswer& answer) { answered(answer.confirmed, answer.of); });
  });
}

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
