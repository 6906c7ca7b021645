#pragma once

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <memory>

#include "host/server/client_stream.hpp"
#include "host/server/connection.hpp"

namespace proleg::host {

/// Opens the WebSocket of a viewer, for which `request` asks. The stream has no unread bytes behind the request.
[[nodiscard]] std::shared_ptr<Connection> open_viewer_connection(
    std::shared_ptr<ConnectionServer> server, ClientStream stream,
    boost::beast::http::request<boost::beast::http::string_body> request);

}  // namespace proleg::host
