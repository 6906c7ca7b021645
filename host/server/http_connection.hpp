#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <memory>

#include "host/server/connection.hpp"

namespace proleg::host {

enum class ConnectionUse { any, only_stop };

/// Opens a connection that handles requests one after the other, after the handshake of TLS if `tls` is not null. A
/// request for a WebSocket makes it a ViewerConnection. only_stop: it handles one request, and refuses any request
/// other than POST /stop with 503.
[[nodiscard]] std::shared_ptr<Connection> open_http_connection(std::shared_ptr<ConnectionServer> server,
                                                               boost::asio::ip::tcp::socket socket,
                                                               boost::asio::ssl::context* tls, ConnectionUse use);

}  // namespace proleg::host
