#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <utility>
#include <variant>

namespace proleg::host {

/// The bytes of a client's connection: TCP, or TLS above it. One type for both, because Beast takes long to compile for
/// each.
class ClientStream {
 public:
  using executor_type = boost::beast::tcp_stream::executor_type;

  /// `tls` is null for plain TCP; else it must live as long as the stream.
  ClientStream(boost::asio::ip::tcp::socket socket, boost::asio::ssl::context* tls)
      : stream_(make_stream(std::move(socket), tls)) {}

  /// The deadlines of a Beast stream are here.
  [[nodiscard]] boost::beast::tcp_stream& tcp() {
    Tls* const tls = std::get_if<Tls>(&stream_);
    return tls == nullptr ? std::get<Tcp>(stream_) : boost::beast::get_lowest_layer(*tls);
  }
  [[nodiscard]] executor_type get_executor() { return tcp().get_executor(); }

  /// Calls the handler at once if there is nothing to agree on.
  template <typename Handler>
  void async_handshake(Handler handler) {
    if (Tls* const tls = std::get_if<Tls>(&stream_)) {
      tls->async_handshake(boost::asio::ssl::stream_base::server, std::move(handler));
    } else {
      handler(boost::system::error_code());
    }
  }

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    std::visit([&](auto& stream) { stream.async_read_some(buffers, std::forward<Handler>(handler)); }, stream_);
  }

  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    std::visit([&](auto& stream) { stream.async_write_some(buffers, std::forward<Handler>(handler)); }, stream_);
  }

  /// Writes bytes that nothing follows, then ends the direction to the client. Unlike other writing it may begin while
  /// Beast writes a frame of its own: plain TCP takes what the system has room for, and TLS puts its records in a row.
  /// The handler is called in any case.
  template <typename Handler>
  void async_write_last(boost::asio::const_buffer bytes, Handler handler) {
    if (Tls* const tls = std::get_if<Tls>(&stream_)) {
      boost::asio::async_write(*tls, bytes,
                               [this, handler = std::move(handler)](const boost::system::error_code&, std::size_t) {
                                 end_sending();
                                 handler();
                               });
      return;
    }
    boost::system::error_code ignored;
    tcp().socket().non_blocking(true, ignored);
    tcp().socket().write_some(bytes, ignored);
    end_sending();
    handler();
  }

  /// Tells the client that no more bytes come. The handler is called in any case, at the latest at the deadline.
  template <typename Handler>
  void async_shutdown(Handler handler) {
    if (Tls* const tls = std::get_if<Tls>(&stream_)) {
      tls->async_shutdown([this, handler = std::move(handler)](const boost::system::error_code&) {
        end_sending();
        handler();
      });
    } else {
      end_sending();
      handler();
    }
  }

  void end_sending() {
    boost::system::error_code ignored;
    tcp().socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
  }

 private:
  using Tcp = boost::beast::tcp_stream;
  using Tls = boost::beast::ssl_stream<boost::beast::tcp_stream>;

  static std::variant<Tcp, Tls> make_stream(boost::asio::ip::tcp::socket socket, boost::asio::ssl::context* tls) {
    if (tls == nullptr) {
      return Tcp(std::move(socket));
    }
    return Tls(std::move(socket), *tls);
  }

  std::variant<Tcp, Tls> stream_;
};

/// Beast closes a WebSocket with these two functions.
inline void beast_close_socket(ClientStream& stream) { stream.tcp().close(); }

/// After the exchange of close frames. It does not wait for the end of the client, which might never come.
template <typename Handler>
void async_teardown(boost::beast::role_type /*role*/, ClientStream& stream, Handler&& handler) {
  stream.end_sending();
  boost::asio::post(stream.get_executor(),
                    boost::beast::bind_handler(std::forward<Handler>(handler), boost::system::error_code()));
}

}  // namespace proleg::host
