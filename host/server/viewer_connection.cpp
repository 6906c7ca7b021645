#include "host/server/viewer_connection.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

namespace proleg::host {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using Request = beast::http::request<beast::http::string_body>;

constexpr std::chrono::seconds upgrade_timeout{5};
constexpr std::chrono::seconds close_handshake_timeout{1};
constexpr std::chrono::seconds silence_timeout{30};
/// Size of the system's buffer for a viewer that does not read: the smaller it is, the newer are the data that it
/// reads.
constexpr int send_buffer_bytes = 128 << 10;

/// The WebSocket of a viewer.
class ViewerConnection final : public Connection, public std::enable_shared_from_this<ViewerConnection> {
 public:
  ViewerConnection(std::shared_ptr<ConnectionServer> server, ClientStream stream)
      : server_(std::move(server)), socket_(std::move(stream)), close_timer_(server_->context()) {}

  void open(Request request);
  void pump() override;
  void end() override { close(CloseReason{1001, "the server ends"}); }
  void end_by_force() override { beast::get_lowest_layer(socket_).tcp().close(); }

 private:
  void read();
  /// Closes the connection. Reading goes on until the viewer ends the connection, or for a second.
  void close(const CloseReason& reason);
  /// Sends the close frame without async_close, because async_close beside an async_read that fails may leave a
  /// handler that never runs (Beast 1.74).
  void send_close_frame();
  void leave();

  const std::shared_ptr<ConnectionServer> server_;
  websocket::stream<ClientStream> socket_;
  asio::steady_timer close_timer_;
  beast::flat_buffer buffer_;
  Request request_;
  std::optional<ClientId> client_;
  SharedText outgoing_;  ///< message that is being sent; null: none
  bool is_closing_ = false;
  CloseReason close_reason_;
  std::string close_frame_;
};

void ViewerConnection::open(Request request) {
  request_ = std::move(request);
  beast::tcp_stream& stream = beast::get_lowest_layer(socket_).tcp();
  stream.expires_never();  // the WebSocket has deadlines of its own
  error_code ignored;
  stream.socket().set_option(asio::socket_base::send_buffer_size(send_buffer_bytes), ignored);
  websocket::stream_base::timeout timeouts{};
  timeouts.handshake_timeout = upgrade_timeout;
  timeouts.idle_timeout = silence_timeout;
  timeouts.keep_alive_pings = true;
  socket_.set_option(timeouts);
  socket_.read_message_max(max_message_bytes);
  socket_.auto_fragment(false);  // a message is one frame, because it is in memory anyway
  socket_.async_accept(request_, [self = shared_from_this()](const error_code& error) {
    if (error) {
      return;
    }
    self->client_ = self->server_->link().hub.add_viewer(server_now());
    self->read();
    self->server_->serve();
  });
}

void ViewerConnection::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](const error_code& error, std::size_t) {
    if (error || !self->client_) {
      self->leave();
      return;
    }
    ViewerHub& hub = self->server_->link().hub;
    if (self->socket_.got_text()) {
      const asio::const_buffer bytes = self->buffer_.cdata();
      hub.receive(server_now(), *self->client_, {static_cast<const char*>(bytes.data()), bytes.size()});
    } else {
      hub.close(*self->client_, 1008, "message: found binary data, expected text");
    }
    self->buffer_.clear();
    self->read();
    self->server_->serve();
  });
}

void ViewerConnection::pump() {
  if (!client_ || is_closing_) {
    return;
  }
  if (const std::optional<CloseReason> reason = server_->link().hub.closing(*client_)) {
    close(*reason);
    return;
  }
  if (outgoing_) {
    return;
  }
  std::optional<OutgoingMessage> message = server_->link().hub.next_message(server_now(), *client_);
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
      self->server_->serve();
    }
  });
}

void ViewerConnection::close(const CloseReason& reason) {
  if (std::exchange(is_closing_, true)) {
    return;
  }
  if (!socket_.is_open()) {
    end_by_force();
    return;
  }
  close_reason_ = reason;
  // The timer ends the wait for a viewer that does not read, since the close frame cannot be sent.
  close_timer_.expires_after(close_handshake_timeout);
  close_timer_.async_wait([self = shared_from_this()](const error_code& error) {
    if (!error) {
      self->leave();
    }
  });
  if (!outgoing_) {
    send_close_frame();
  }
}

void ViewerConnection::send_close_frame() {
  const auto high = static_cast<char>(close_reason_.code >> 8U);
  const auto low = static_cast<char>(close_reason_.code & 0xFFU);
  close_frame_ = std::string{'\x88', static_cast<char>(close_reason_.text.size() + 2), high, low} + close_reason_.text;
  beast::get_lowest_layer(socket_).async_write_last(asio::buffer(close_frame_), [self = shared_from_this()] {});
}

void ViewerConnection::leave() {
  is_closing_ = true;
  close_timer_.cancel();
  end_by_force();
  if (client_) {
    server_->link().hub.remove_viewer(server_now(), *std::exchange(client_, std::nullopt));
    server_->serve();
  }
}

}  // namespace

std::shared_ptr<Connection> open_viewer_connection(std::shared_ptr<ConnectionServer> server, ClientStream stream,
                                                   Request request) {
  auto connection = std::make_shared<ViewerConnection>(std::move(server), std::move(stream));
  connection->open(std::move(request));
  return connection;
}

}  // namespace proleg::host
