#include "host/server/client_stream.hpp"

#include <boost/asio/write.hpp>
#include <boost/beast/core/stream_traits.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <variant>

namespace proleg::host {
namespace {

using boost::system::error_code;
using Tcp = boost::beast::tcp_stream;
using Tls = boost::beast::ssl_stream<Tcp>;

std::variant<Tcp, Tls> make_stream(boost::asio::ip::tcp::socket socket, boost::asio::ssl::context* tls) {
  if (tls == nullptr) {
    return Tcp(std::move(socket));
  }
  return Tls(std::move(socket), *tls);
}

}  // namespace

std::string address_of(const boost::asio::ip::tcp::socket& socket) {
  error_code error;
  const auto end = socket.remote_endpoint(error);
  return error ? std::string() : end.address().to_string();
}

struct ClientStream::Layers {
  std::variant<Tcp, Tls> stream;
  Tls* tls() { return std::get_if<Tls>(&stream); }
};

ClientStream::ClientStream(boost::asio::ip::tcp::socket socket, boost::asio::ssl::context* tls)
    : layers_(new Layers{make_stream(std::move(socket), tls)}) {}
ClientStream::ClientStream(ClientStream&&) noexcept = default;
ClientStream::~ClientStream() = default;

boost::beast::tcp_stream& ClientStream::tcp() {
  Tls* const tls = layers_->tls();
  return tls == nullptr ? std::get<Tcp>(layers_->stream) : boost::beast::get_lowest_layer(*tls);
}

void ClientStream::async_handshake(std::function<void(const error_code&)> handler) {
  if (Tls* const tls = layers_->tls()) {
    tls->async_handshake(boost::asio::ssl::stream_base::server, std::move(handler));
  } else {
    handler(error_code());
  }
}

void ClientStream::read_some(const std::vector<boost::asio::mutable_buffer>& buffers, Transferred handler) {
  std::visit([&](auto& stream) { stream.async_read_some(buffers, std::move(handler)); }, layers_->stream);
}

void ClientStream::write_some(const std::vector<boost::asio::const_buffer>& buffers, Transferred handler) {
  std::visit([&](auto& stream) { stream.async_write_some(buffers, std::move(handler)); }, layers_->stream);
}

void ClientStream::async_write_last(boost::asio::const_buffer bytes, std::function<void()> handler) {
  if (Tls* const tls = layers_->tls()) {
    boost::asio::async_write(*tls, bytes, [this, handler = std::move(handler)](const error_code&, std::size_t) {
      end_sending();
      handler();
    });
    return;
  }
  error_code ignored;
  tcp().socket().non_blocking(true, ignored);
  tcp().socket().write_some(bytes, ignored);
  end_sending();
  handler();
}

void ClientStream::async_shutdown(std::function<void()> handler) {
  if (Tls* const tls = layers_->tls()) {
    tls->async_shutdown([this, handler = std::move(handler)](const error_code&) {
      end_sending();
      handler();
    });
  } else {
    end_sending();
    handler();
  }
}

void ClientStream::end_sending() {
  error_code ignored;
  tcp().socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
}

}  // namespace proleg::host
