#include "host/transport/bus_address.hpp"

#include <algorithm>
#include <optional>

#include "host/transport/serial_device.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

using Kind = BusAddress::Kind;

constexpr std::size_t max_interface_name = 15;  // IFNAMSIZ - 1
constexpr unsigned max_channel = 30;            // RFCOMM
constexpr unsigned max_port = 65'535;
constexpr unsigned max_descriptor = 65'535;

[[noreturn]] void fail(std::string_view argument, const std::string& expected) {
  throw InputError("bus", 0, in_quotes(argument), expected);
}

unsigned parse_number(std::string_view argument, std::string_view text, unsigned first, unsigned last,
                      const std::string& what) {
  const auto number = parse_whole<unsigned>(text);
  if (!number || *number < first || *number > last) {
    fail(argument, what + " from " + std::to_string(first) + " to " + std::to_string(last));
  }
  return *number;
}

BusAddress parse_can(std::string_view argument) {
  const auto is_usual = [](unsigned char character) { return character > ' ' && character < 0x7F && character != '/'; };
  if (argument.find('/') != std::string_view::npos) {
    fail(argument, "a bus; a serial line is 'serial:" + std::string(argument) + "'");
  }
  if (argument.empty() || argument.size() > max_interface_name ||
      !std::all_of(argument.begin(), argument.end(), is_usual)) {
    fail(argument, "a bus: " + bus_address_syntax());
  }
  return {Kind::can, std::string(argument), 0, {}};
}

BusAddress parse_serial(std::string_view argument, std::string_view rest) {
  const std::size_t at = rest.rfind('@');
  const std::string_view device = rest.substr(0, at);
  if (device.empty() || device.find('\0') != std::string_view::npos) {
    fail(argument, "serial:DEVICE[@BAUD], for example serial:/dev/ttyUSB0");
  }
  unsigned baud = BusAddress::default_baud;
  if (at != std::string_view::npos) {
    const auto number = parse_whole<unsigned>(rest.substr(at + 1));
    if (!number || !serial_speed(*number)) {
      fail(argument, "a baud rate that Linux has: " + serial_speeds_text());
    }
    baud = *number;
  }
  return {Kind::serial, std::string(device), baud, {}};
}

BusAddress parse_bluetooth(std::string_view argument, std::string_view rest) {
  constexpr std::size_t text_length = 17;
  const std::string expected = "bluetooth:AA:BB:CC:DD:EE:FF[/CHANNEL]";
  BusAddress address{Kind::bluetooth, {}, BusAddress::default_channel, {}};
  const std::string_view bytes = rest.substr(0, text_length);
  if (bytes.size() != text_length) {
    fail(argument, expected);
  }
  for (std::size_t i = 0; i < address.bluetooth.size(); ++i) {
    const auto byte = parse_whole<std::uint8_t>(bytes.substr(3 * i, 2), 16);
    const bool is_separated = i == 0 || bytes[3 * i - 1] == ':';
    if (!byte || !is_separated) {
      fail(argument, expected);
    }
    address.bluetooth[i] = *byte;
  }
  const std::string_view channel = rest.substr(text_length);
  if (!channel.empty()) {
    if (channel.front() != '/') {
      fail(argument, expected);
    }
    address.number = parse_number(argument, channel.substr(1), 1, max_channel, "an RFCOMM channel");
  }
  return address;
}

BusAddress parse_tcp(std::string_view argument, std::string_view rest) {
  const std::size_t colon = rest.rfind(':');
  std::string_view host = rest.substr(0, colon);
  const bool has_brackets = host.size() >= 2 && host.front() == '[' && host.back() == ']';
  if (has_brackets) {
    host = host.substr(1, host.size() - 2);
  }
  if (colon == std::string_view::npos || host.empty() || host.find('\0') != std::string_view::npos ||
      (!has_brackets && host.find(':') != std::string_view::npos)) {
    fail(argument, "tcp:HOST:PORT, for example tcp:127.0.0.1:20000 or tcp:[::1]:20000");
  }
  return {Kind::tcp, std::string(host), parse_number(argument, rest.substr(colon + 1), 1, max_port, "a port"), {}};
}

BusAddress parse_simulation(std::string_view argument, std::string_view rest) {
  if (rest.empty() || rest.find('\0') != std::string_view::npos) {
    fail(argument, "sim:FILE.simulation.xml");
  }
  return {Kind::simulation, std::string(rest), 0, {}};
}

}  // namespace

BusAddress parse_bus_address(std::string_view argument) {
  if (argument == "auto") {
    return {};
  }
  const std::size_t colon = argument.find(':');
  if (colon == std::string_view::npos) {
    return parse_can(argument);
  }
  const std::string kind = lower_case(argument.substr(0, colon));
  const std::string_view rest = argument.substr(colon + 1);
  if (kind == "serial") {
    return parse_serial(argument, rest);
  }
  if (kind == "bluetooth") {
    return parse_bluetooth(argument, rest);
  }
  if (kind == "tcp") {
    return parse_tcp(argument, rest);
  }
  if (kind == "fd") {
    return {Kind::descriptor, {}, parse_number(argument, rest, 0, max_descriptor, "a descriptor"), {}};
  }
  if (kind == "sim") {
    return parse_simulation(argument, rest);
  }
  fail(argument, "a bus: " + bus_address_syntax());
}

std::string bus_address_text(const BusAddress& address) {
  switch (address.kind) {
    case Kind::can:
      return address.name;
    case Kind::serial:
      return "serial:" + address.name + "@" + std::to_string(address.number);
    case Kind::bluetooth: {
      std::string text = "bluetooth";
      for (const std::uint8_t byte : address.bluetooth) {
        text += ':';
        text += hexadecimal(byte, 2).substr(2);
      }
      return text + "/" + std::to_string(address.number);
    }
    case Kind::tcp: {
      const bool needs_brackets = address.name.find(':') != std::string::npos;
      return "tcp:" + (needs_brackets ? "[" + address.name + "]" : address.name) + ":" + std::to_string(address.number);
    }
    case Kind::descriptor:
      return "fd:" + std::to_string(address.number);
    case Kind::simulation:
      return "sim:" + address.name;
    case Kind::automatic:
      break;
  }
  return "auto";
}

const std::string& bus_address_syntax() {
  static const std::string syntax =
      "a CAN interface such as can0, serial:DEVICE[@BAUD], bluetooth:AA:BB:CC:DD:EE:FF[/CHANNEL], tcp:HOST:PORT, fd:N, "
      "sim:FILE.simulation.xml or auto";
  return syntax;
}

}  // namespace proleg::host
