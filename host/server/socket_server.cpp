// The only source that includes Boost.Beast: it takes half a minute to compile.

#include "host/server/socket_server.hpp"

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "host/server/request_policy.hpp"

namespace proleg::host {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using tcp = asio::ip::tcp;
using Request = http::request<http::string_body>;

constexpr std::size_t max_connections = 64;
constexpr std::uint32_t max_header_bytes = 8U << 10U;
constexpr std::uint64_t max_body_bytes = 4U << 10U;
constexpr std::chrono::seconds request_timeout{5};
constexpr std::chrono::seconds response_timeout{30};
constexpr std::chrono::seconds close_timeout{1};
constexpr std::chrono::seconds silence_timeout{30};
constexpr std::chrono::milliseconds accept_pause{100};
/// The system keeps as much for a viewer that does not read: the less, the fresher is what it reads at last.
constexpr int send_buffer_bytes = 128 << 10;

ServerTime server_now() {
  return std::chrono::duration_cast<ServerTime>(std::chrono::steady_clock::now().time_since_epoch());
}

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

std::vector<std::string_view> fields(const Request& request, http::field name) {
  std::vector<std::string_view> values;
  const auto range = request.equal_range(name);
  for (auto field = range.first; field != range.second; ++field) {
    values.push_back(view(field->value()));
  }
  return values;
}

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

}  // namespace

class SocketServer::Service : public std::enable_shared_from_this<Service> {
 public:
  Service(asio::io_context& context, std::uint16_t port, std::shared_ptr<SessionLink> link);

  void accept();
  /// From any thread.
  void post_delivery() {
    asio::post(context_, [self = shared_from_this()] {
      self->link_->deliver();
      self->serve();
    });
  }
  void post_stop() {
    asio::post(context_, [self = shared_from_this()] { self->stop(); });
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  class HttpConnection;
  class ViewerConnection;

  void accepted(tcp::socket socket);
  void stop();
  /// After each event: sends what can be sent, and waits for the next deadline.
  void serve();
  /// Those that have not ended; forgets the others.
  [[nodiscard]] std::vector<std::shared_ptr<Connection>> living_connections();

  asio::io_context& context_;
  const std::shared_ptr<SessionLink> link_;
  tcp::acceptor acceptor_;
  asio::steady_timer timer_;
  asio::steady_timer accept_timer_;
  ServerTime timer_deadline_ = no_deadline;
  std::uint16_t port_ = 0;
  bool has_ended_ = false;
  std::vector<std::weak_ptr<Connection>> connections_;
};

/// Requests, one after the other.
class SocketServer::Service::HttpConnection final : public Connection,
                                                    public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(std::shared_ptr<Service> service, tcp::socket socket)
      : service_(std::move(service)), stream_(std::move(socket)) {}

  void read();
  void end() override { end_by_force(); }
  void end_by_force() override { stream_.close(); }

 private:
  void handle_request(const error_code& error);
  /// `body` must live as long as the service.
  void respond(unsigned status, std::string_view content_type, std::string_view body, bool is_kept_alive);
  /// An error: its words are the body.
  void respond_error(unsigned status, bool is_kept_alive);
  /// Lets the other end read the response: an early end of a connection with unread bytes would discard it.
  void drain();
  void upgrade(Request request);

  const std::shared_ptr<Service> service_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{max_header_bytes + max_body_bytes};
  std::optional<http::request_parser<http::string_body>> parser_;
  std::string host_;  ///< of the present request, once it was accepted
  bool is_head_ = false;
  std::string header_;
};

/// The WebSocket of a viewer.
class SocketServer::Service::ViewerConnection final : public Connection,
                                                      public std::enable_shared_from_this<ViewerConnection> {
 public:
  ViewerConnection(std::shared_ptr<Service> service, tcp::socket socket)
      : service_(std::move(service)), socket_(std::move(socket)), close_timer_(service_->context_) {}

  void open(Request request);
  void pump() override;
  void end() override { close(CloseReason{1001, "the server ends"}); }
  void end_by_force() override { beast::get_lowest_layer(socket_).close(); }

 private:
  void read();
  /// Reading goes on until the viewer ends the connection, or for a second.
  void close(const CloseReason& reason);
  /// By hand: async_close beside an async_read that fails may leave a handler behind that never runs (Beast 1.74).
  void send_close_frame();
  void leave();

  const std::shared_ptr<Service> service_;
  websocket::stream<beast::tcp_stream> socket_;
  asio::steady_timer close_timer_;
  beast::flat_buffer buffer_;
  Request request_;
  std::optional<ClientId> client_;
  SharedText outgoing_;  ///< what is on its way; null: nothing
  bool is_closing_ = false;
  CloseReason close_reason_;
};

void SocketServer::Service::HttpConnection::read() {
  parser_.emplace();
  parser_->header_limit(max_header_bytes);
  parser_->body_limit(max_body_bytes);
  host_.clear();
  is_head_ = false;
  stream_.expires_after(request_timeout);
  http::async_read(stream_, buffer_, *parser_,
                   [self = shared_from_this()](const error_code& error, std::size_t) { self->handle_request(error); });
}

void SocketServer::Service::HttpConnection::handle_request(const error_code& error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    respond_error(431, false);
  } else if (error == http::error::body_limit) {
    respond_error(413, false);
  } else if (error && error != http::error::end_of_stream && error != http::error::partial_message &&
             error.category() == make_error_code(http::error::bad_version).category()) {
    respond_error(400, false);
  }
  if (error) {
    return;
  }
  Request request = parser_->release();
  RequestFields asked;
  asked.method = view(request.method_string());
  asked.target = view(request.target());
  asked.hosts = fields(request, http::field::host);
  asked.origins = fields(request, http::field::origin);
  asked.authorizations = fields(request, http::field::authorization);
  asked.is_upgrade = websocket::is_upgrade(request);
  const RequestDecision decision = decide_request(asked, service_->port_, service_->link_->token);
  is_head_ = request.method() == http::verb::head;
  host_ = decision.status == 421 ? "" : std::string(asked.hosts.front());
  const bool is_kept_alive = request.keep_alive();
  switch (decision.action) {
    case RequestAction::refuse:
      respond_error(decision.status, is_kept_alive);
      return;
    case RequestAction::stop:
      service_->link_->hub.stop("POST /stop");
      respond(200, "application/json", R"({"stopped": true})", is_kept_alive);
      return;
    case RequestAction::open_socket:
      // Before the answer a client sends nothing that it could not send after it.
      if (buffer_.size() > 0) {
        respond_error(400, false);
      } else {
        upgrade(std::move(request));
      }
      return;
    case RequestAction::serve_file:
      break;
  }
  const PageFile* const file = service_->link_->page.find(path_of(asked.target));
  if (file == nullptr) {
    respond_error(404, is_kept_alive);
  } else {
    respond(200, file->content_type, file->bytes, is_kept_alive);
  }
}

void SocketServer::Service::HttpConnection::respond_error(unsigned status, bool is_kept_alive) {
  respond(status, "text/plain; charset=utf-8", status_words(status), is_kept_alive);
}

void SocketServer::Service::HttpConnection::respond(unsigned status, std::string_view content_type,
                                                    std::string_view body, bool is_kept_alive) {
  header_ = response_header(status, content_type, body.size(), host_, is_kept_alive);
  const std::array<asio::const_buffer, 2> buffers{
      asio::buffer(header_), is_head_ ? asio::const_buffer() : asio::const_buffer(body.data(), body.size())};
  stream_.expires_after(response_timeout);
  asio::async_write(stream_, buffers, [self = shared_from_this(), is_kept_alive](const error_code& error, std::size_t) {
    if (!error && is_kept_alive) {
      self->read();
    } else if (!error) {
      self->stream_.expires_after(close_timeout);
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
      self->drain();
    }
  });
}

void SocketServer::Service::HttpConnection::drain() {
  buffer_.clear();
  stream_.async_read_some(buffer_.prepare(max_body_bytes),
                          [self = shared_from_this()](const error_code& error, std::size_t) {
                            if (!error) {
                              self->drain();
                            }
                          });
}

void SocketServer::Service::HttpConnection::upgrade(Request request) {
  const auto viewer = std::make_shared<ViewerConnection>(service_, stream_.release_socket());
  service_->connections_.push_back(viewer);
  viewer->open(std::move(request));
}

void SocketServer::Service::ViewerConnection::open(Request request) {
  request_ = std::move(request);
  error_code ignored;
  beast::get_lowest_layer(socket_).socket().set_option(asio::socket_base::send_buffer_size(send_buffer_bytes), ignored);
  websocket::stream_base::timeout timeouts{};
  timeouts.handshake_timeout = request_timeout;
  timeouts.idle_timeout = silence_timeout;
  timeouts.keep_alive_pings = true;
  socket_.set_option(timeouts);
  socket_.read_message_max(max_message_bytes);
  socket_.auto_fragment(false);  // a message is in memory anyway: one frame
  socket_.async_accept(request_, [self = shared_from_this()](const error_code& error) {
    if (error) {
      return;
    }
    self->client_ = self->service_->link_->hub.add_viewer(server_now());
    self->read();
    self->service_->serve();
  });
}

void SocketServer::Service::ViewerConnection::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](const error_code& error, std::size_t) {
    if (error || !self->client_) {
      self->leave();
      return;
    }
    ViewerHub& hub = self->service_->link_->hub;
    if (self->socket_.got_text()) {
      const asio::const_buffer bytes = self->buffer_.cdata();
      hub.receive(server_now(), *self->client_, {static_cast<const char*>(bytes.data()), bytes.size()});
    } else {
      hub.close(*self->client_, 1008, "message: found binary data, expected text");
    }
    self->buffer_.clear();
    self->read();
    self->service_->serve();
  });
}

void SocketServer::Service::ViewerConnection::pump() {
  if (!client_ || is_closing_) {
    return;
  }
  if (const std::optional<CloseReason> reason = service_->link_->hub.closing(*client_)) {
    close(*reason);
    return;
  }
  if (outgoing_) {
    return;
  }
  std::optional<OutgoingMessage> message = service_->link_->hub.next_message(server_now(), *client_);
  if (!message) {
    return;
  }
  outgoing_ = std::move(message->bytes);
  socket_.binary(message->is_binary);
  socket_.async_write(asio::buffer(*outgoing_), [self = shared_from_this()](const error_code& error, std::size_t) {
    self->outgoing_ = nullptr;
    if (!error && self->is_closing_) {
      self->send_close_frame();
    } else if (!error) {
      self->service_->serve();
    }
  });
}

void SocketServer::Service::ViewerConnection::close(const CloseReason& reason) {
  if (std::exchange(is_closing_, true)) {
    return;
  }
  if (!socket_.is_open()) {
    end_by_force();
    return;
  }
  close_reason_ = reason;
  // A viewer that does not read keeps the close frame from being sent.
  close_timer_.expires_after(close_timeout);
  close_timer_.async_wait([self = shared_from_this()](const error_code& error) {
    if (!error) {
      self->leave();
    }
  });
  if (!outgoing_) {
    send_close_frame();
  }
}

void SocketServer::Service::ViewerConnection::send_close_frame() {
  const auto high = static_cast<char>(close_reason_.code >> 8U);
  const auto low = static_cast<char>(close_reason_.code & 0xFFU);
  const std::string frame =
      std::string{'\x88', static_cast<char>(close_reason_.text.size() + 2), high, low} + close_reason_.text;
  tcp::socket& socket = beast::get_lowest_layer(socket_).socket();
  error_code ignored;
  socket.non_blocking(true, ignored);
  socket.write_some(asio::buffer(frame), ignored);
  socket.shutdown(tcp::socket::shutdown_send, ignored);
}

void SocketServer::Service::ViewerConnection::leave() {
  is_closing_ = true;
  close_timer_.cancel();
  end_by_force();
  if (client_) {
    service_->link_->hub.remove_viewer(server_now(), *std::exchange(client_, std::nullopt));
    service_->serve();
  }
}

SocketServer::Service::Service(asio::io_context& context, std::uint16_t port, std::shared_ptr<SessionLink> link)
    : context_(context), link_(std::move(link)), acceptor_(context), timer_(context), accept_timer_(context) {
  try {
    const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(asio::socket_base::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen();
    port_ = acceptor_.local_endpoint().port();
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error("127.0.0.1:" + std::to_string(port) + ": found " + error.code().message() +
                             ", expected a free port");
  }
}

void SocketServer::Service::accept() {
  acceptor_.async_accept([self = shared_from_this()](const error_code& error, tcp::socket socket) {
    if (self->has_ended_) {
      return;
    }
    if (!error) {
      self->accepted(std::move(socket));
      self->accept();
      return;
    }
    // Perhaps the process has no file descriptors left; another attempt at once would fail, too.
    self->accept_timer_.expires_after(accept_pause);
    self->accept_timer_.async_wait([self](const error_code&) {
      if (!self->has_ended_) {
        self->accept();
      }
    });
  });
}

void SocketServer::Service::accepted(tcp::socket socket) {
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  if (living_connections().size() >= max_connections) {
    socket.non_blocking(true, ignored);
    const std::string_view words = status_words(503);
    std::string response = response_header(503, "text/plain; charset=utf-8", words.size(), {}, false);
    response += words;
    socket.write_some(asio::buffer(response), ignored);
    return;
  }
  const auto connection = std::make_shared<HttpConnection>(shared_from_this(), std::move(socket));
  connections_.push_back(connection);
  connection->read();
}

std::vector<std::shared_ptr<Connection>> SocketServer::Service::living_connections() {
  std::vector<std::shared_ptr<Connection>> living;
  std::erase_if(connections_, [&living](const std::weak_ptr<Connection>& known) {
    if (std::shared_ptr<Connection> connection = known.lock()) {
      living.push_back(std::move(connection));
      return false;
    }
    return true;
  });
  return living;
}

void SocketServer::Service::serve() {
  const ServerTime now = server_now();
  link_->hub.advance(now);
  for (const std::shared_ptr<Connection>& connection : living_connections()) {
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

void SocketServer::Service::stop() {
  if (std::exchange(has_ended_, true)) {
    return;
  }
  error_code ignored;
  acceptor_.close(ignored);
  accept_timer_.cancel();
  timer_.cancel();
  for (const std::shared_ptr<Connection>& connection : living_connections()) {
    connection->end();
  }
}

SocketServer::SocketServer(asio::io_context& context, std::uint16_t port, std::shared_ptr<SessionLink> link)
    : service_(std::make_shared<Service>(context, port, std::move(link))) {
  service_->accept();
}

std::uint16_t SocketServer::port() const { return service_->port(); }

void SocketServer::post_delivery() { service_->post_delivery(); }

void SocketServer::post_stop() { service_->post_stop(); }

}  // namespace proleg::host
