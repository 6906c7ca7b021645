#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "host/transport/line_server.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/serial/serial_line.hpp"

namespace proleg::tools {

/// The address at which a program listens: PORT, ADDRESS:PORT or, for an IPv6 address, [ADDRESS]:PORT.
struct ServedPort {
  std::string address = "127.0.0.1";  ///< address without brackets; by default only for programs of this computer
  std::uint16_t port = 0;             ///< 0: any free port
};

/// Parses an argument. Throws InputError, which names the option.
[[nodiscard]] ServedPort parse_served_port(const std::string& option, const std::string& argument);

/// The value of --bus that reaches the port: "tcp:127.0.0.1:20000", "tcp:[::1]:20000".
[[nodiscard]] std::string bus_argument(const ServedPort& served);

/// The module of a simulated robot that is a gateway, and the place at which programs reach its serial line.
struct GatewayPlace {
  unsigned joint = 0;
  std::optional<ServedPort> tcp;  ///< port on TCP; nothing: a pseudo terminal
};

/// Parses the value of --gateway: NODE, NODE=pty or NODE=[ADDRESS:]PORT. Throws InputError.
[[nodiscard]] GatewayPlace parse_gateway(const sim::Scenario& scenario, const std::string& argument);

/// The program on the serial line of a simulated module. The line has 1 Mbaud, so each byte takes 10 us of the robot's
/// time in either direction. A program that sends faster has to wait.
class GatewayLine final : public sim::SerialHost {
 public:
  /// now: returns the time of the robot; called only from the io_context. event: that of host::LineServer.
  GatewayLine(boost::asio::io_context& context, std::function<sim::BusTime()> now,
              std::function<void(const std::string& line)> event);

  /// Opens the line for programs. Returns the value of --bus that reaches the line. Throws host::TransportError.
  std::string open(const GatewayPlace& place);

  void received(sim::BusTime time, std::uint8_t byte) override;
  [[nodiscard]] sim::BusTime next_event() const override { return sender_.next_event(); }
  [[nodiscard]] std::optional<sim::SerialCharacter> take(sim::BusTime now) override;
  [[nodiscard]] sim::BusTime bit_time() const override { return sender_.bit_time(); }

 private:
  static constexpr std::uint32_t baud = 1'000'000;
  /// Largest number of bytes under way to the module.
  static constexpr std::size_t capacity = 4'096;
  /// Time by which the program of a module may run ahead of the bus (SerialHost), so no byte begins earlier.
  static constexpr sim::BusTime reaction_ns = 200'000;

  [[nodiscard]] std::size_t room();

  std::function<sim::BusTime()> now_;
  sim::SerialSender sender_{baud};
  bool is_waiting_ = false;  ///< the program waits for room
  host::LineServer server_;
};

}  // namespace proleg::tools
