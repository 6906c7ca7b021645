#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace proleg::host {

/// The address of the computer at the other end; empty if the connection has ended.
[[nodiscard]] std::string address_of(const boost::asio::ip::tcp::socket& socket);

/// The stream of a client's connection: TCP, or TLS above it. Handlers and buffers have one type each below, because
/// Boost takes long to compile for each combination.
class ClientStream {
 public:
  using executor_type = boost::beast::tcp_stream::executor_type;
  /// Receives the error and the number of bytes.
  using Transferred = std::function<void(const boost::system::error_code&, std::size_t)>;

  /// `tls` is null for plain TCP; otherwise it must live as long as the stream.
  ClientStream(boost::asio::ip::tcp::socket socket, boost::asio::ssl::context* tls);
  ClientStream(ClientStream&&) noexcept;
  ~ClientStream();

  /// The TCP stream, which has the deadlines of a Beast stream.
  [[nodiscard]] boost::beast::tcp_stream& tcp();
  [[nodiscard]] executor_type get_executor() { return tcp().get_executor(); }

  /// Performs the handshake of TLS. Calls the handler at once for plain TCP.
  void async_handshake(std::function<void(const boost::system::error_code&)> handler);

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    read_some(list<boost::asio::mutable_buffer>(buffers), copyable(std::forward<Handler>(handler)));
  }

  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    write_some(list<boost::asio::const_buffer>(buffers), copyable(std::forward<Handler>(handler)));
  }

  /// Writes the last bytes, then ends the direction to the client. Unlike other writing it may begin while Beast
  /// writes a frame of its own: plain TCP takes the bytes for which the system has room, and TLS puts its records in a
  /// row. The handler is called in any case.
  void async_write_last(boost::asio::const_buffer bytes, std::function<void()> handler);

  /// Informs the client that no more bytes come. The handler is called in any case, at the latest at the deadline.
  void async_shutdown(std::function<void()> handler);

  void end_sending();

 private:
  struct Layers;

  void read_some(const std::vector<boost::asio::mutable_buffer>& buffers, Transferred handler);
  void write_some(const std::vector<boost::asio::const_buffer>& buffers, Transferred handler);

  template <typename Buffer, typename Buffers>
  static std::vector<Buffer> list(const Buffers& buffers) {
    return {boost::asio::buffer_sequence_begin(buffers), boost::asio::buffer_sequence_end(buffers)};
  }
  /// Makes a handler that can be copied from one of Beast, which can only be moved.
  template <typename Handler>
  static Transferred copyable(Handler&& handler) {
    return [kept = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler))](
               const boost::system::error_code& error, std::size_t bytes) { std::move (*kept)(error, bytes); };
  }

  std::unique_ptr<Layers> layers_;
};

/// Beast closes a WebSocket with these two functions.
inline void beast_close_socket(ClientStream& stream) { stream.tcp().close(); }

/// Shuts the stream down after the exchange of close frames. It does not wait for the client to end the connection,
/// which might never happen.
template <typename Handler>
void async_teardown(boost::beast::role_type /*role*/, ClientStream& stream, Handler&& handler) {
  stream.end_sending();
  boost::asio::post(stream.get_executor(),
                    boost::beast::bind_handler(std::forward<Handler>(handler), boost::system::error_code()));
}

}  // namespace proleg::host
