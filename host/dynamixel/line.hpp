#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>

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

}  // namespace proleg::host
