#pragma once

// Fault confinement of a CAN node (ISO 11898-1:2003, clause 13; Bosch CAN 2.0, part B, section 8).

#include <cstdint>

namespace proleg::sim {

enum class ErrorState : std::uint8_t {
  active,   ///< signals errors with a dominant flag
  passive,  ///< a counter is above 127: signals recessively, and waits 8 bits after each of its frames
  bus_off,  ///< the transmit error counter is above 255: takes no part in the bus
};

/// The last error, with the numbers of bxCAN's ESR.LEC (RM0090, 32.9.2).
enum class CanError : std::uint8_t {
  none = 0,
  stuff = 1,
  form = 2,
  acknowledgement = 3,
  bit_recessive = 4,  ///< recessive sent, dominant seen
  bit_dominant = 5,   ///< dominant sent, recessive seen
  crc = 6,
};

/// The two counters of a node and what follows from them.
class ErrorCounters {
 public:
  /// 0 to 255; 256 and more is bus-off, after which both stay until reset().
  [[nodiscard]] unsigned transmit_errors() const { return transmit_; }
  /// 0 to 135. ISO does not define the count above 128; like bxCAN this one stops above 127.
  [[nodiscard]] unsigned receive_errors() const { return receive_; }
  [[nodiscard]] ErrorState state() const;

  /// Rule c: an error while transmitting: +8.
  void transmitter_error();
  /// Rule a: an error while receiving: +1.
  void receiver_error();
  /// Rule g: a frame was transmitted: -1, not below 0.
  void transmitted();
  /// Rule h: a frame was received: -1, not below 0; above 127 down to 127 (ISO: 119 to 127).
  void received();
  /// As after power-on and after bus-off.
  void reset() { transmit_ = receive_ = 0; }

 private:
  unsigned transmit_ = 0;
  unsigned receive_ = 0;
};

}  // namespace proleg::sim
