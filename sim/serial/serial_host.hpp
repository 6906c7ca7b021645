#pragma once

#include <cstdint>
#include <optional>

#include "sim/bus/controller.hpp"
#include "sim/serial/serial_receiver.hpp"

namespace proleg::sim {

/// The other end of a module's serial line: a host, or what stands for one.
class SerialHost {
 public:
  /// The module has sent a character; its stop bit ends at this time. A module whose program runs ahead of the bus may
  /// report it up to 200 us early: a host that answers takes longer.
  virtual void received(BusTime time, std::uint8_t byte) = 0;
  /// When it sends the next character; never_on_bus if that follows only from what it receives.
  [[nodiscard]] virtual BusTime next_event() const = 0;
  /// The character that begins now, if one does. One character must be over before the next one begins.
  [[nodiscard]] virtual std::optional<SerialCharacter> take(BusTime now) = 0;
  /// Of the characters that it sends, in ns.
  [[nodiscard]] virtual BusTime bit_time() const = 0;

 protected:
  ~SerialHost() = default;
};

}  // namespace proleg::sim
