#include "host/transport/open_transport.hpp"

#include <filesystem>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

std::unique_ptr<Link> make_link(const BusAddress& address) {
  switch (address.kind) {
    case BusAddress::Kind::serial:
      return make_serial_link(address.name, address.number);
    case BusAddress::Kind::bluetooth:
      return make_bluetooth_link(address);
    case BusAddress::Kind::tcp:
      return make_tcp_link(address.name, address.number);
    case BusAddress::Kind::descriptor:
      return make_descriptor_link(static_cast<int>(address.number));
    case BusAddress::Kind::simulation:
      // The program reports a missing file too, but as a second line, after the line about the lost connection.
      if (!std::filesystem::is_regular_file(address.name)) {
        throw InputError("--bus", 0, in_quotes(bus_address_text(address)), "sim:FILE with a scenario that is there");
      }
      return make_program_link(program_folder() + "proleg-bus", address.name);
    case BusAddress::Kind::can:
    case BusAddress::Kind::automatic:
      break;
  }
  throw TransportError(bus_address_text(address) + ": name the bus: " + bus_address_syntax());
}

}  // namespace

std::unique_ptr<Transport> open_transport(boost::asio::io_context& context, const BusAddress& address,
                                          TransportListener& listener) {
  if (address.kind == BusAddress::Kind::can) {
    return open_can_transport(context, address.name, listener);
  }
  return open_slcan_transport(context, bus_address_text(address), make_link(address), listener);
}

}  // namespace proleg::host
