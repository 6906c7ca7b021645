#pragma once

#include <span>
#include <string>

#include "host/dynamixel/line.hpp"

namespace proleg::host {

/// The rates of servos (e-manual, Baud Rate(8)): 9600, 57600, 115200, 1, 2, 3 and 4 Mbit/s.
[[nodiscard]] std::span<const unsigned> serial_rates();

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
