#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace proleg::host {

/// Where a CAN bus is, as the user writes it:
///   can0                                   a CAN interface of Linux (SocketCAN), also vcan0, slcan0, ...
///   serial:/dev/ttyUSB0[@BAUD]             an slcan adapter, or a module that serves as one, on a serial line
///   bluetooth:AA:BB:CC:DD:EE:FF[/CHANNEL]  such an adapter over RFCOMM
///   tcp:HOST:PORT                          such an adapter over TCP; an IPv6 address stands in brackets
///   fd:N                                   such an adapter over a socket that this process has inherited
///   sim:FILE.simulation.xml                simulated modules, by the program proleg-bus
///   auto                                   the only adapter that has modules behind it
struct BusAddress {
  enum class Kind : std::uint8_t { can, serial, bluetooth, tcp, descriptor, simulation, automatic };

  static constexpr unsigned default_baud = 1'000'000;  ///< 20 modules at 10 ms a tick fit
  static constexpr unsigned default_channel = 1;       ///< RFCOMM channel

  Kind kind = Kind::automatic;
  std::string name;     ///< interface, device, host or file
  unsigned number = 0;  ///< baud rate, RFCOMM channel (1 to 30), TCP port (1 to 65535) or descriptor
  std::array<std::uint8_t, 6> bluetooth{};  ///< as written, the most significant byte first

  friend bool operator==(const BusAddress&, const BusAddress&) = default;
};

/// Reads an address. Throws InputError for an argument that is not an address. Does not check whether the bus exists.
[[nodiscard]] BusAddress parse_bus_address(std::string_view argument);

/// The complete text of an address, from which parse_bus_address() makes the same address.
[[nodiscard]] std::string bus_address_text(const BusAddress& address);

/// The kinds of addresses, for help texts and errors.
[[nodiscard]] const std::string& bus_address_syntax();

}  // namespace proleg::host
