// Boost.Beast takes long to compile: this source, client_stream.cpp and viewer_connection.cpp are compiled by
// themselves.

#include "host/server/connection.hpp"

#include <array>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/server/client_stream.hpp"
#include "host/server/relay_connection.hpp"
#include "host/server/request_policy.hpp"
#include "host/server/viewer_connection.hpp"

namespace proleg::host {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;
using Request = http::request<http::string_body>;

constexpr std::uint32_t max_header_bytes = 8U << 10U;
constexpr std::uint64_t max_body_bytes = 4U << 10U;
constexpr std::chrono::seconds request_timeout{5};
constexpr std::chrono::seconds response_timeout{30};
constexpr std::chrono::seconds close_timeout{1};

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

std::vector<std::string_view> fields(const Request& request, http::field name) {
  std::vector<std::string_view> values;
  const auto range = request.equal_range(name);
  for (auto field = range.first; field != range.second; ++field) {
    values.push_back(view(field->value()));
  }
  return values;
}

/// A connection that handles HTTP requests, one after the other.
class HttpConnection final : public Connection, public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(std::shared_ptr<ConnectionServer> server, ClientStream stream, ConnectionUse use)
      : server_(std::move(server)), stream_(std::move(stream)), use_(use) {}

  void open();
  void end() override { end_by_force(); }
  void end_by_force() override { stream_.tcp().close(); }

 private:
  void read();
  void handle_request(const error_code& error);
  /// Does what a request to this server asks for, which was accepted.
  void act(Request request, RequestAction action, bool is_kept_alive);
  /// The same for the program of a seat.
  void act_for_seat(const Request& request, RequestAction action, SeatNumber number, const SeatDirectory::Seat& seat,
                    bool is_kept_alive);
  void respond_stopped(bool is_kept_alive);
  void serve_file(std::string_view path, bool is_kept_alive);
  /// Sends a response. `body` must live as long as the server or this.
  void respond(unsigned status, std::string_view content_type, std::string_view body, bool is_kept_alive);
  /// Sends an error, whose body is the text of its status.
  void respond_error(unsigned status, bool is_kept_alive);
  /// Refuses a request, and says why if the way to the server is the cause.
  void refuse(const RequestFields& asked, unsigned status, bool is_kept_alive);
  /// Reads and ignores bytes while the other end reads the response: closing a connection with unread bytes would
  /// discard the response.
  void drain();
  void upgrade(Request request);
  void open_seat(const Request& request, SeatNumber seat, std::optional<std::uint16_t> port, bool is_look);
  void join(const Request& request, bool is_kept_alive);

  const std::shared_ptr<ConnectionServer> server_;
  ClientStream stream_;
  const ConnectionUse use_;
  beast::flat_buffer buffer_{max_header_bytes + max_body_bytes};
  std::optional<http::request_parser<http::string_body>> parser_;
  std::string socket_origin_;  ///< origin of the WebSocket for the present request, after its Host was accepted
  bool is_head_ = false;
  std::string header_;
  std::string body_;  ///< of a document, or of an error if it is not the text of its status
};

void HttpConnection::open() {
  stream_.tcp().expires_after(request_timeout);
  stream_.async_handshake([self = shared_from_this()](const error_code& error) {
    if (!error) {
      self->read();
    }
  });
}

void HttpConnection::read() {
  parser_.emplace();
  parser_->header_limit(max_header_bytes);
  parser_->body_limit(max_body_bytes);
  socket_origin_.clear();
  is_head_ = false;
  stream_.tcp().expires_after(request_timeout);
  http::async_read(stream_, buffer_, *parser_,
                   [self = shared_from_this()](const error_code& error, std::size_t) { self->handle_request(error); });
}

void HttpConnection::handle_request(const error_code& error) {
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
  asked.is_upgrade = beast::websocket::is_upgrade(request);
  SeatDirectory* const seats = server_->seats();
  const std::optional<SeatPath> path =
      seats == nullptr ? SeatPath{std::nullopt, asked.target} : seat_path(asked.target);
  const bool is_of_seat = path && path->seat;
  const std::optional<SeatDirectory::Seat> seat = is_of_seat ? seats->find(*path->seat) : std::nullopt;
  asked.target = path ? path->target : asked.target;
  asked.may_join = seats != nullptr && !is_of_seat;
  RequestDecision decision = decide_request(asked, server_->address(), seat ? seat->token : server_->link().token);
  if (decision.action != RequestAction::refuse && (!path || (is_of_seat && !seat))) {
    decision = {RequestAction::refuse, 404};
  }
  is_head_ = request.method() == http::verb::head;
  socket_origin_ = decision.status == 421 ? "" : socket_origin(server_->address(), asked.hosts.front());
  const bool is_only_stop = use_ == ConnectionUse::only_stop;
  const bool is_kept_alive = request.keep_alive() && !is_only_stop;
  if (is_only_stop && decision.action != RequestAction::stop && decision.action != RequestAction::refuse) {
    respond_error(503, false);
  } else if (decision.action == RequestAction::refuse) {
    refuse(asked, decision.status, is_kept_alive);
  } else if (seat) {
    act_for_seat(request, decision.action, *path->seat, *seat, is_kept_alive);
  } else {
    act(std::move(request), decision.action, is_kept_alive);
  }
}

void HttpConnection::act(Request request, RequestAction action, bool is_kept_alive) {
  if (action == RequestAction::stop) {
    server_->link().hub.stop("POST /stop");
    respond_stopped(is_kept_alive);
  } else if (action == RequestAction::open_socket && buffer_.size() == 0) {
    upgrade(std::move(request));
  } else if (action == RequestAction::open_socket) {
    respond_error(400, false);  // a client has no reason to send bytes of the WebSocket before the answer
  } else if (action == RequestAction::join) {
    join(request, is_kept_alive);
  } else {
    const std::string_view path = path_of(view(request.target()));
    serve_file(server_->seats() != nullptr && path == "/" ? "/class.html" : path, is_kept_alive);
  }
}

void HttpConnection::act_for_seat(const Request& request, RequestAction action, SeatNumber number,
                                  const SeatDirectory::Seat& seat, bool is_kept_alive) {
  SeatDirectory& seats = *server_->seats();
  if (action == RequestAction::stop) {
    seats.stop(number);
    respond_stopped(is_kept_alive);
    return;
  }
  if (!seat.port) {
    seats.wake(number);
  }
  const std::string_view target = seat_path(view(request.target()))->target;
  if (action == RequestAction::open_socket && buffer_.size() == 0) {
    open_seat(request, number, seat.port, only_looks(target));
  } else if (action == RequestAction::open_socket) {
    respond_error(400, false);
  } else {
    serve_file(path_of(target), is_kept_alive);
  }
}

void HttpConnection::respond_stopped(bool is_kept_alive) {
  respond(200, "application/json", R"({"stopped": true})", is_kept_alive);
}

void HttpConnection::serve_file(std::string_view path, bool is_kept_alive) {
  if (const PageFile* const file = server_->link().page.find(path)) {
    respond(200, file->content_type, file->bytes, is_kept_alive);
  } else if (std::optional<PageFile> document = server_->link().documents.read(path)) {
    body_ = std::move(document->bytes);
    respond(200, document->content_type, body_, is_kept_alive);
  } else {
    respond_error(404, is_kept_alive);
  }
}

void HttpConnection::respond_error(unsigned status, bool is_kept_alive) {
  respond(status, "text/plain; charset=utf-8", status_words(status), is_kept_alive);
}

void HttpConnection::refuse(const RequestFields& asked, unsigned status, bool is_kept_alive) {
  constexpr unsigned forbidden = 403;
  constexpr unsigned misdirected = 421;
  if (status != forbidden && status != misdirected) {
    respond_error(status, is_kept_alive);
    return;
  }
  server_->report_refusal(refusal_line(asked, server_->address(), status));
  body_ = refusal_text(asked, server_->address(), status);
  respond(status, "text/plain; charset=utf-8", body_, is_kept_alive);
}

void HttpConnection::respond(unsigned status, std::string_view content_type, std::string_view body,
                             bool is_kept_alive) {
  header_ = response_header(status, content_type, body.size(), socket_origin_, is_kept_alive);
  const std::array<asio::const_buffer, 2> buffers{
      asio::buffer(header_), is_head_ ? asio::const_buffer() : asio::const_buffer(body.data(), body.size())};
  stream_.tcp().expires_after(response_timeout);
  asio::async_write(stream_, buffers, [self = shared_from_this(), is_kept_alive](const error_code& error, std::size_t) {
    if (!error && is_kept_alive) {
      self->read();
    } else if (!error) {
      self->stream_.tcp().expires_after(close_timeout);
      self->stream_.async_shutdown([self] { self->drain(); });
    }
  });
}

void HttpConnection::drain() {
  buffer_.clear();
  stream_.tcp().async_read_some(buffer_.prepare(max_body_bytes),
                                [self = shared_from_this()](const error_code& error, std::size_t) {
                                  if (!error) {
                                    self->drain();
                                  }
                                });
}

void HttpConnection::upgrade(Request request) {
  const std::string address = address_of(stream_.tcp().socket());
  server_->add(open_viewer_connection(server_, std::move(stream_), std::move(request)), address);
}

void HttpConnection::open_seat(const Request& request, SeatNumber seat, std::optional<std::uint16_t> port,
                               bool is_look) {
  SeatDirectory& seats = *server_->seats();
  const std::string address = address_of(stream_.tcp().socket());
  std::unique_ptr<SeatVisitors::Visit> visit =
      port ? server_->visitors().begin(seat, address, std::chrono::steady_clock::now()) : nullptr;
  if (visit == nullptr) {
    respond_error(503, false);  // the page tries again
    return;
  }
  std::function<void()> ended;
  if (!is_look) {
    seats.connected(seat);
    ended = [&seats, seat] { seats.disconnected(seat); };
  }
  server_->add(open_relay_connection(server_, std::move(stream_), request, *port, std::move(visit), std::move(ended)),
               address);
}

void HttpConnection::join(const Request& request, bool is_kept_alive) {
  stream_.tcp().expires_never();  // the program of the seat may have to start
  server_->seats()->join(request.body(), address_of(stream_.tcp().socket()),
                         [self = shared_from_this(), is_kept_alive](const SeatDirectory::Answer& answer) {
                           asio::post(self->server_->context(), [self, is_kept_alive, answer] {
                             self->body_ = answer.json;
                             self->respond(answer.status, "application/json", self->body_, is_kept_alive);
                           });
                         });
}

}  // namespace

std::shared_ptr<Connection> open_http_connection(std::shared_ptr<ConnectionServer> server, asio::ip::tcp::socket socket,
                                                 asio::ssl::context* tls, ConnectionUse use) {
  auto connection = std::make_shared<HttpConnection>(std::move(server), ClientStream(std::move(socket), tls), use);
  connection->open();
  return connection;
}

}  // namespace proleg::host
