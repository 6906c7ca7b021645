#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <memory>

#include "host/server/connection.hpp"

namespace proleg::host {

enum class ConnectionUse { any, only_stop };

/// Takes requests, one after the other, after the handshake of TLS if there is `tls`. A WebSocket becomes a
/// ViewerConnection. With only_stop: one request, which other than POST /stop is refused with 503.
[[nodiscard]] std::shared_ptr<Connection> open_http_connection(std::shared_ptr<ConnectionServer> server,
                                                               boost::asio::ip::tcp::socket socket,
                                                               boost::asio::ssl::context* tls, ConnectionUse use);

}  // namespace proleg::host
