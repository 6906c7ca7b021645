#pragma once

// What a module needs of the world. A board (or the simulator) implements these and hands events to Module.

#include <cstdint>

#include "shared/can/can_port.hpp"

namespace proleg::firmware {

class ServoPort {
 public:
  /// Sends pulses of this width, in twelfths of a microsecond, from now on.
  virtual void pulse(std::int32_t width) = 0;
  /// No pulses: the servo goes limp.
  virtual void off() = 0;

 protected:
  ~ServoPort() = default;
};

class ContactPort {
 public:
  /// Touch sensors as they are now, as in byte 6 of the state frame: bits 0-1 the link behind the joint (rear, front),
  /// bits 2-3 the link before it, of which only the head module has sensors.
  [[nodiscard]] virtual std::uint8_t read() = 0;

 protected:
  ~ContactPort() = default;
};

struct Ports {
  CanPort& can;
  ServoPort& servo;
  ContactPort& contacts;
};

}  // namespace proleg::firmware
