#pragma once

#include <cstdint>

namespace proleg {

/// Error state of a CAN controller (ISO 11898-1). `error_warning` is error active with a counter above 95, as Linux
/// counts it.
enum class CanState : std::uint8_t { error_active, error_warning, error_passive, bus_off };

/// The error state of a controller and its counters.
struct CanStatus {
  CanState state = CanState::error_active;
  std::uint16_t receive_errors = 0;   ///< the controller's receive error counter
  std::uint16_t transmit_errors = 0;  ///< the controller's transmit error counter; 256 or more is bus-off

  friend bool operator==(const CanStatus&, const CanStatus&) = default;
};

/// Kinds of errors that a controller or its driver reports.
enum class CanErrorKind : std::uint8_t {
  acknowledgement,   ///< no node acknowledged a frame
  bit_dominant,      ///< a dominant bit was sent, a recessive one read back (Linux: bit 0)
  bit_recessive,     ///< a recessive bit was sent, a dominant one read back (Linux: bit 1)
  crc,               ///< the checksum of a received frame is wrong
  form,              ///< a bit with a fixed value has the opposite value
  receive_overrun,   ///< a received frame was lost because the receiver had no room
  transmit_overrun,  ///< a frame to be sent was lost because the transmitter had no room
  stuff,             ///< six equal bits in a row
};
inline constexpr unsigned can_error_kinds = 8;

/// A set of kinds of errors.
class CanErrors {
 public:
  constexpr CanErrors() = default;
  constexpr void add(CanErrorKind kind) { bits_ = static_cast<std::uint8_t>(bits_ | bit(kind)); }
  constexpr void add(CanErrors others) { bits_ = static_cast<std::uint8_t>(bits_ | others.bits_); }
  [[nodiscard]] constexpr bool contains(CanErrorKind kind) const { return (bits_ & bit(kind)) != 0; }
  [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }

  friend constexpr bool operator==(CanErrors, CanErrors) = default;

 private:
  static constexpr unsigned bit(CanErrorKind kind) { return 1U << static_cast<unsigned>(kind); }

  std::uint8_t bits_ = 0;
};

}  // namespace proleg
