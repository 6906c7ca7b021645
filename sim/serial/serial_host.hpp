#pragma once

#include <cstdint>
#include <optional>

#include "sim/bus/controller.hpp"
#include "sim/serial/serial_receiver.hpp"

namespace proleg::sim {

/// The other end of a module's serial line: a host, or a substitute for one.
class SerialHost {
 public:
  /// Receives a character from the module; its stop bit ends at this time. A module whose program runs ahead of the bus
  /// may report it up to 200 us early: the answer of a host takes longer.
  virtual void received(BusTime time, std::uint8_t byte) = 0;
  /// Time at which it sends the next character; never_on_bus if it waits for a character.
  [[nodiscard]] virtual BusTime next_event() const = 0;
  /// Takes the character that begins now; nothing if none does. A character must end before the next one begins.
  [[nodiscard]] virtual std::optional<SerialCharacter> take(BusTime now) = 0;
  /// Duration of a bit that it sends, in ns.
  [[nodiscard]] virtual BusTime bit_time() const = 0;

 protected:
  ~SerialHost() = default;
};

}  // namespace proleg::sim
