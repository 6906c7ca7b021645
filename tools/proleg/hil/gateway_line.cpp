#include "tools/proleg/hil/gateway_line.hpp"

#include <string_view>
#include <utility>

#include "host/transport/bus_address.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/scenario_run.hpp"

namespace proleg::tools {

ServedPort parse_served_port(const std::string& option, const std::string& argument) {
  ServedPort served;
  std::string_view port = argument;
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
    throw InputError(option, 0, in_quotes(argument), "PORT, ADDRESS:PORT or [IPV6_ADDRESS]:PORT; port 0: any free one");
  }
  served.port = *number;
  return served;
}

std::string bus_argument(const ServedPort& served) {
  return host::bus_address_text({host::BusAddress::Kind::tcp, served.address, served.port, {}});
}

GatewayPlace parse_gateway(const sim::Scenario& scenario, const std::string& argument) {
  const std::size_t equal = argument.find('=');
  const std::string node = argument.substr(0, equal);
  GatewayPlace place;
  place.joint = joint_of_node(scenario, parse_whole<std::uint32_t>(node), "--gateway", in_quotes(node));
  if (equal != std::string::npos && argument.substr(equal + 1) != "pty") {
    place.tcp = parse_served_port("--gateway", argument.substr(equal + 1));
  }
  return place;
}

GatewayLine::GatewayLine(boost::asio::io_context& context, std::function<sim::BusTime()> now,
                         std::function<void(const std::string& line)> event)
    : now_(std::move(now)),
      server_(context, {[this](std::string_view bytes) { sender_.send(now_() + reaction_ns, bytes); },
                        [this] { return room(); }, std::move(event)}) {}

std::string GatewayLine::open(const GatewayPlace& place) {
  if (!place.tcp) {
    return "serial:" + server_.open_pseudo_terminal();
  }
  ServedPort served = *place.tcp;
  served.port = server_.listen(served.address, served.port);
  return bus_argument(served);
}

void GatewayLine::received(sim::BusTime /*time*/, std::uint8_t byte) {
  const char character = static_cast<char>(byte);
  server_.send({&character, 1});
}

std::optional<sim::SerialCharacter> GatewayLine::take(sim::BusTime now) {
  const auto character = sender_.take(now);
  if (is_waiting_ && sender_.pending() <= capacity / 2) {
    is_waiting_ = false;
    server_.resume();
  }
  return character;
}

std::size_t GatewayLine::room() {
  is_waiting_ = sender_.pending() >= capacity;
  return is_waiting_ ? 0 : capacity - sender_.pending();
}

}  // namespace proleg::tools
