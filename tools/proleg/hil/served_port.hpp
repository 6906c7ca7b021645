#pragma once

#include <cstdint>
#include <string>

namespace proleg::tools {

/// The address at which a program listens: PORT, ADDRESS:PORT or, for an IPv6 address, [ADDRESS]:PORT.
struct ServedPort {
  std::string address = "127.0.0.1";  ///< address without brackets; by default only for programs of this computer
  std::uint16_t port = 0;             ///< 0: any free port
};

/// Parses an argument. Throws InputError, which names the option.
[[nodiscard]] ServedPort parse_served_port(const std::string& option, const std::string& word);

/// The value of --bus that reaches the port: "tcp:127.0.0.1:20000", "tcp:[::1]:20000".
[[nodiscard]] std::string bus_word(const ServedPort& served);

}  // namespace proleg::tools
