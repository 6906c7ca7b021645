#pragma once

// The serial line to the servos: the port, and that of the operating system.

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace proleg::host {

/// The serial line failed: it cannot be opened, it was unplugged. what(): one line, with what to do.
class LineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Port: the serial line to the servos, and the clock of its deadlines.
class Line {
 public:
  virtual ~Line() = default;

  /// The time in microseconds; never decreases.
  [[nodiscard]] virtual std::uint64_t now_us() = 0;
  /// Sends bytes. May return before they are on the line. Throws LineError.
  virtual void write(std::span<const std::uint8_t> bytes) = 0;
  /// Waits for bytes until the deadline. Returns how many were received, 0 at the deadline. Throws LineError.
  virtual std::size_t read(std::span<std::uint8_t> into, std::uint64_t deadline_us) = 0;
  /// Forgets received bytes that were not read. Throws LineError.
  virtual void discard_input() = 0;
};

/// The rates of servos (e-manual, Baud Rate(8)): 9600, 57600, 115200, 1, 2, 3 and 4 Mbit/s.
[[nodiscard]] std::span<const unsigned> serial_rates();

/// What a user can do if answers come late from this device.
[[nodiscard]] std::string latency_advice(const std::string& device);

/// A serial port of the operating system: 8 data bits, no parity, 1 stop bit, no flow control, for this process alone.
class SerialLine final : public Line {
 public:
  /// Opens the port. rate: one of serial_rates(). Throws LineError.
  SerialLine(const std::string& device, unsigned rate);
  ~SerialLine() override;
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  [[nodiscard]] std::uint64_t now_us() override;
  void write(std::span<const std::uint8_t> bytes) override;
  std::size_t read(std::span<std::uint8_t> into, std::uint64_t deadline_us) override;
  void discard_input() override;

 private:
  void configure(unsigned rate);
  bool wait_for(short events, std::uint64_t deadline_us);
  [[noreturn]] void fail(const std::string& action, int error) const;

  std::string device_;
  int descriptor_ = -1;
};

}  // namespace proleg::host
