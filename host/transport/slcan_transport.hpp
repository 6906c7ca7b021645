#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>

#include "host/transport/link.hpp"
#include "host/transport/transport.hpp"

namespace proleg::host {

/// A bus behind an slcan adapter. Returns when the adapter's channel is open. A connection that is lost later is made
/// again, after 0.1 s at first and 5 s at last, if the link allows it; the listener receives each change.
/// address: the text that errors begin with. Throws TransportError.
[[nodiscard]] std::unique_ptr<Transport> open_slcan_transport(boost::asio::io_context& context,
                                                              const std::string& address, std::unique_ptr<Link> link,
                                                              TransportListener& listener);

}  // namespace proleg::host
