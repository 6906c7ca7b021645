#pragma once

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "host/server/client_stream.hpp"
#include "host/server/connection.hpp"
#include "host/server/seats.hpp"

namespace proleg::host {

/// Passes the bytes of a WebSocket, for which `request` asks, between a client and the program of a seat. The stream
/// has no unread bytes behind the request. ended: called once, at the end, if it is not empty.
[[nodiscard]] std::shared_ptr<Connection> open_relay_connection(
    std::shared_ptr<ConnectionServer> server, ClientStream stream,
    const boost::beast::http::request<boost::beast::http::string_body>& request, std::uint16_t port,
    std::unique_ptr<SeatVisitors::Visit> visit, std::function<void()> ended);

}  // namespace proleg::host
