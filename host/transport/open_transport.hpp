#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>

#include "host/transport/bus_address.hpp"
#include "host/transport/link.hpp"
#include "host/transport/transport.hpp"

namespace proleg::host {

/// Opens a bus and returns when it is connected. The listener may be called before. Throws TransportError with one
/// line that begins with the address. The caller handles `auto`, because it can examine the bus behind each adapter.
[[nodiscard]] std::unique_ptr<Transport> open_transport(boost::asio::io_context& context, const BusAddress& address,
                                                        TransportListener& listener);

/// Opens a CAN interface of Linux. An interface that goes down or away later is opened again when it is back; the
/// listener receives each change. Throws TransportError with the interface's name at its beginning.
[[nodiscard]] std::unique_ptr<Transport> open_can_transport(boost::asio::io_context& context,
                                                            const std::string& interface, TransportListener& listener);

/// Opens a bus behind an slcan adapter. Returns when the adapter's channel is open. A connection that is lost later is
/// made again, after 0.1 s at first and 5 s at last, if the link allows it; the listener receives each change.
/// address: the text that errors begin with. Throws TransportError.
[[nodiscard]] std::unique_ptr<Transport> open_slcan_transport(boost::asio::io_context& context,
                                                              const std::string& address, std::unique_ptr<Link> link,
                                                              TransportListener& listener);

}  // namespace proleg::host
