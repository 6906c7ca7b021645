#pragma once

// The interfaces that a module needs. Drivers of the chip, or the simulator, implement these ports and pass events to
// Module.

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/module/board_record.hpp"
#include "shared/broadcast/transfer_frame.hpp"
#include "shared/can/can_port.hpp"
#include "shared/gait/joint_readings.hpp"

namespace proleg::firmware {

class ServoPort {
 public:
  /// Begins a pulse of this width, in twelfths of a microsecond, and repeats it every period from now on. If the pulse
  /// before is not over yet, the width is that of the next one. The program requests each pulse; the port repeats a
  /// pulse only if the program is late, a little after the period.
  virtual void pulse(std::int32_t width, std::uint32_t period_us) = 0;
  /// Stops the pulses: the servo has no torque. A pulse that has begun ends with its width.
  virtual void off() = 0;
  /// Switches the servo's supply, on a board with a switch for it. It is off before the first call.
  virtual void switch_supply(bool /*is_on*/) {}

 protected:
  ~ServoPort() = default;
};

class ContactPort {
 public:
  /// Present state of the touch sensors, as in byte 6 of the state frame: bits 0-1 the link behind the joint (rear,
  /// front), bits 2-3 the link in front of it, of which only the head module has sensors.
  [[nodiscard]] virtual std::uint8_t read_contacts() = 0;

 protected:
  ~ContactPort() = default;
};

class SensorPort {
 public:
  /// Returns the last readings and starts the next ones. Called once a tick, and while ticks are missing.
  [[nodiscard]] virtual ServoReadings take_readings() = 0;
  /// Sets whether there is a feedback potentiometer, and its readings, from now on. Ports that read angles ignore the
  /// call.
  virtual void calibrate(const BoardRecord& /*board*/) {}

 protected:
  ~SensorPort() = default;
};

/// The serial line to a host: USART2 of the reference board, 1 Mbaud (docs/board.md).
class LinePort {
 public:
  /// Takes the line for the gateway, or gives it back to the console. It is taken when the console has sent its text.
  /// Characters that wait are dropped.
  virtual void connect(bool is_gateway) = 0;
  /// Moves the oldest characters that were received, and returns their number.
  [[nodiscard]] virtual std::size_t read_line(std::span<char> characters) = 0;
  /// Whether characters were lost or damaged since the last call: these, and perhaps some before them, are missing.
  [[nodiscard]] virtual bool take_damage() = 0;
  /// Room for characters to send; empty while the last ones are being sent, and without connect(true).
  [[nodiscard]] virtual std::span<char> line_room() = 0;
  /// Sends the first characters of line_room().
  virtual void send_line(std::size_t count) = 0;

 protected:
  ~LinePort() = default;
};

/// What the bootloader is to install.
struct Installation {
  std::size_t size = 0;       ///< bytes in the buffer
  std::uint8_t session = 0;   ///< session of the host that has sent them (shared/broadcast)
  bool ends_line = false;     ///< the host is on the module's serial line, and cannot reach the bootloader
  Microseconds run_time = 0;  ///< time since the start of the program
};

/// The program's own place in flash, and the bootloader that starts it (docs/flashing.md).
class ProgramPort {
 public:
  /// RAM for an image that is to replace the program.
  [[nodiscard]] virtual std::span<std::uint8_t> buffer() = 0;
  /// The header of the program's image (shared/image/image_header.hpp).
  [[nodiscard]] virtual std::span<const std::uint8_t> header() const = 0;
  /// Whether a bootloader has started the program.
  [[nodiscard]] virtual bool has_bootloader() const = 0;
  /// Whether the program was confirmed before; else it runs on trial.
  [[nodiscard]] virtual bool is_confirmed() const = 0;
  /// Confirms the program: from now on it starts without a trial. It writes a word of flash, which takes 16 us.
  virtual void confirm() = 0;
  /// Notes that the program has started well this time.
  virtual void note_good_start() = 0;
  /// Which images the bootloader takes.
  [[nodiscard]] virtual broadcast::TrustSummary trust_summary() const { return {}; }
  /// Restarts into the bootloader, which installs the first bytes of the buffer.
  virtual void install(const Installation& what) = 0;
  /// Restarts into the bootloader, which stays on the bus.
  virtual void enter_bootloader() = 0;

 protected:
  ~ProgramPort() = default;
};

struct Ports {
  CanPort& can;
  ServoPort& servo;
  ContactPort& contacts;
  SensorPort& sensors;
  FlashPort& flash;
  LinePort* line = nullptr;        ///< null: the module cannot be a gateway
  ProgramPort* program = nullptr;  ///< null: the module takes no images
};

}  // namespace proleg::firmware
