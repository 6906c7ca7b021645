#include "host/server/relay_connection.hpp"

#include <array>
#include <boost/asio/ip/address_v4.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <string>
#include <string_view>
#include <utility>

namespace proleg::host {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;
using tcp = asio::ip::tcp;

constexpr std::size_t piece_bytes = 16U << 10U;
constexpr std::chrono::seconds longest_end{1};
/// Size of the system's buffers on the way to a client: what waits in them is old when it is read.
constexpr int relay_buffer_bytes = 64 << 10;

class RelayConnection final : public Connection, public std::enable_shared_from_this<RelayConnection> {
 public:
  RelayConnection(asio::io_context& context, ClientStream stream, std::unique_ptr<SeatVisitors::Visit> visit,
                  std::function<void()> ended)
      : client_(std::move(stream)),
        program_(context),
        pause_(context),
        end_timer_(context),
        visit_(std::move(visit)),
        ended_(std::move(ended)) {}
  ~RelayConnection() override {
    if (ended_) {
      ended_();
    }
  }
  RelayConnection(const RelayConnection&) = delete;
  RelayConnection& operator=(const RelayConnection&) = delete;

  void open(const http::request<http::string_body>& request, std::uint16_t port);
  void end() override { end_by_force(); }
  void end_by_force() override;

 private:
  void read_client();
  void write_program(std::size_t bytes);
  void read_program();
  /// The program sends no more: what it has sent goes to the client, then both connections end.
  void program_ended();

  ClientStream client_;
  tcp::socket program_;
  asio::steady_timer pause_;
  asio::steady_timer end_timer_;
  const std::unique_ptr<SeatVisitors::Visit> visit_;
  const std::function<void()> ended_;
  std::string request_;
  std::array<char, piece_bytes> from_client_{};
  std::array<char, piece_bytes> from_program_{};
  bool has_program_ended_ = false;
};

/// The program of a seat serves this computer alone: it gets a request as from a program here. Who may open the page
/// was decided before.
std::string request_to_program(const http::request<http::string_body>& request, std::uint16_t port) {
  std::string text = "GET /socket HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                     "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n";
  for (const std::string_view name : {"Sec-WebSocket-Key", "Sec-WebSocket-Version"}) {
    const auto value = request[boost::beast::string_view(name.data(), name.size())];
    text += std::string(name) + ": " + std::string(value.data(), value.size()) + "\r\n";
  }
  return text + "\r\n";
}

void RelayConnection::open(const http::request<http::string_body>& request, std::uint16_t port) {
  client_.tcp().expires_never();  // the program ends the connection of a client that is silent
  error_code ignored;
  client_.tcp().socket().set_option(asio::socket_base::send_buffer_size(relay_buffer_bytes), ignored);
  request_ = request_to_program(request, port);
  program_.open(tcp::v4(), ignored);
  program_.set_option(asio::socket_base::receive_buffer_size(relay_buffer_bytes), ignored);
  program_.async_connect(
      {asio::ip::address_v4::loopback(), port}, [self = shared_from_this()](const error_code& error) {
        if (error) {
          self->end_by_force();
          return;
        }
        error_code no_matter;
        self->program_.set_option(tcp::no_delay(true), no_matter);
        asio::async_write(self->program_, asio::buffer(self->request_), [self](const error_code& failure, std::size_t) {
          if (failure) {
            self->end_by_force();
          } else {
            self->read_client();
            self->read_program();
          }
        });
      });
}

void RelayConnection::end_by_force() {
  pause_.cancel();
  end_timer_.cancel();
  client_.tcp().close();
  error_code ignored;
  program_.close(ignored);
}

void RelayConnection::read_client() {
  client_.async_read_some(
      asio::buffer(from_client_), [self = shared_from_this()](const error_code& error, std::size_t bytes) {
        const bool is_end = error == asio::error::eof || error == asio::ssl::error::stream_truncated;
        if (error && (self->has_program_ended_ || !is_end)) {
          self->end_by_force();
        } else if (error) {
          error_code ignored;
          self->program_.shutdown(tcp::socket::shutdown_send, ignored);
        } else if (self->has_program_ended_) {
          self->read_client();  // bytes that are not read would discard what was sent last
        } else {
          self->write_program(bytes);
        }
      });
}

void RelayConnection::write_program(std::size_t bytes) {
  const std::chrono::milliseconds wait = visit_->budget().spend(std::chrono::steady_clock::now(), bytes);
  asio::async_write(program_, asio::buffer(from_client_.data(), bytes),
                    [self = shared_from_this(), wait](const error_code& error, std::size_t) {
                      if (error || wait.count() == 0) {
                        self->read_client();  // also after an error, which read_program() gets as well
                        return;
                      }
                      self->pause_.expires_after(wait);
                      self->pause_.async_wait([self](const error_code& cancelled) {
                        if (!cancelled) {
                          self->read_client();
                        }
                      });
                    });
}

void RelayConnection::read_program() {
  program_.async_read_some(asio::buffer(from_program_),
                           [self = shared_from_this()](const error_code& error, std::size_t bytes) {
                             if (error) {
                               self->program_ended();
                               return;
                             }
                             asio::async_write(self->client_, asio::buffer(self->from_program_.data(), bytes),
                                               [self](const error_code& failure, std::size_t) {
                                                 if (failure) {
                                                   self->end_by_force();
                                                 } else {
                                                   self->read_program();
                                                 }
                                               });
                           });
}

void RelayConnection::program_ended() {
  if (std::exchange(has_program_ended_, true)) {
    return;
  }
  end_timer_.expires_after(longest_end);
  end_timer_.async_wait([self = shared_from_this()](const error_code& cancelled) {
    if (!cancelled) {
      self->end_by_force();
    }
  });
  client_.async_write_last(asio::const_buffer(), [self = shared_from_this()] {});
}

}  // namespace

std::shared_ptr<Connection> open_relay_connection(std::shared_ptr<ConnectionServer> server, ClientStream stream,
                                                  const http::request<http::string_body>& request, std::uint16_t port,
                                                  std::unique_ptr<SeatVisitors::Visit> visit,
                                                  std::function<void()> ended) {
  auto connection =
      std::make_shared<RelayConnection>(server->context(), std::move(stream), std::move(visit), std::move(ended));
  connection->open(request, port);
  return connection;
}

}  // namespace proleg::host
