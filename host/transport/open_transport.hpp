#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>

#include "host/transport/bus_address.hpp"
#include "host/transport/transport.hpp"

namespace proleg::host {

/// Opens a bus and returns when it is connected. The listener may be called before. Throws TransportError with one line
/// that begins with the address. `auto` is for the caller, which looks at what is behind each adapter.
[[nodiscard]] std::unique_ptr<Transport> open_transport(boost::asio::io_context& context, const BusAddress& address,
                                                        TransportListener& listener);

}  // namespace proleg::host
