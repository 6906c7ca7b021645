#include "tools/proleg/hil/served_port.hpp"

#include <string_view>

#include "host/transport/bus_address.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

ServedPort parse_served_port(const std::string& option, const std::string& word) {
  ServedPort served;
  std::string_view port = word;
  if (const std::size_t colon = port.rfind(':'); colon != std::string_view::npos) {
    std::string_view address = port.substr(0, colon);
    port.remove_prefix(colon + 1);
    if (address.size() > 2 && address.front() == '[' && address.back() == ']') {
      address = address.substr(1, address.size() - 2);
    } else if (address.empty() || address.find(':') != std::string_view::npos) {
      port = {};  // in an IPv6 address without brackets the begin of the port is unknown
    }
    served.address = address;
  }
  const auto number = parse_whole<std::uint16_t>(port);
  if (!number) {
    throw InputError(option, 0, in_quotes(word), "PORT, ADDRESS:PORT or [IPV6_ADDRESS]:PORT; port 0: any free one");
  }
  served.port = *number;
  return served;
}

std::string bus_word(const ServedPort& served) {
  return host::bus_address_text({host::BusAddress::Kind::tcp, served.address, served.port, {}});
}

}  // namespace proleg::tools
