#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <optional>
#include <string>

#include "host/transport/line_server.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/serial/serial_host.hpp"
#include "sim/serial/serial_sender.hpp"
#include "tools/proleg/hil/served_port.hpp"

namespace proleg::tools {

/// Which module of a simulated robot is a gateway, and where programs reach its serial line.
struct GatewayPlace {
  unsigned joint = 0;
  std::optional<ServedPort> tcp;  ///< nothing: a pseudo terminal
};

/// The value of --gateway: NODE, NODE=pty or NODE=[ADDRESS:]PORT. Throws InputError.
[[nodiscard]] GatewayPlace parse_gateway(const sim::Scenario& scenario, const std::string& word);

/// The program on the serial line of a simulated module: 1 Mbaud, so each byte takes 10 us of the robot's time in
/// either direction. A program that sends faster has to wait.
class GatewayLine final : public sim::SerialHost {
 public:
  /// now: the time of the robot; called from the io_context only. event: as host::LineServer has it.
  GatewayLine(boost::asio::io_context& context, std::function<sim::BusTime()> now,
              std::function<void(const std::string& line)> event);

  /// Lets programs in. Returns what --bus takes to reach the line. Throws host::TransportError.
  std::string open(const GatewayPlace& place);

  void received(sim::BusTime time, std::uint8_t byte) override;
  [[nodiscard]] sim::BusTime next_event() const override { return sender_.next_event(); }
  [[nodiscard]] std::optional<sim::SerialCharacter> take(sim::BusTime now) override;
  [[nodiscard]] sim::BusTime bit_time() const override { return sender_.bit_time(); }

 private:
  static constexpr std::uint32_t baud = 1'000'000;
  /// So many bytes are under way to the module at most.
  static constexpr std::size_t capacity = 4'096;
  /// The program of a module may run ahead of the bus by this (SerialHost), so no byte begins earlier.
  static constexpr sim::BusTime reaction_ns = 200'000;

  [[nodiscard]] std::size_t room();

  std::function<sim::BusTime()> now_;
  sim::SerialSender sender_{baud};
  bool is_waiting_ = false;  ///< the program, for room
  host::LineServer server_;
};

}  // namespace proleg::tools
