#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>

#include "host/transport/transport.hpp"

namespace proleg::host {

/// A CAN interface of Linux. An interface that goes down or away later is opened again when it is back; the listener
/// receives each change. Throws TransportError with the interface's name at its beginning.
[[nodiscard]] std::unique_ptr<Transport> open_can_transport(boost::asio::io_context& context,
                                                            const std::string& interface, TransportListener& listener);

}  // namespace proleg::host
