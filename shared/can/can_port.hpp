#pragma once

#include <cstdint>
#include <span>

#include "shared/can/can_frame.hpp"

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

/// Time on the clock of a node: microseconds since power-on.
using Microseconds = std::uint64_t;
/// A deadline that never comes.
inline constexpr Microseconds never = ~Microseconds{0};

/// NMT, SYNC and EMCY have identifiers below this. One mailbox of a controller is for them only, so that waiting frames
/// with higher identifiers do not delay them.
inline constexpr std::uint16_t end_of_urgent_identifiers = 0x100;

/// A node's output to the bus. The node receives frames, and the report that a frame was sent, as events.
class CanPort {
 public:
  /// Passes a frame to the controller, which sends it when the bus is free, lower identifiers first. False if all its
  /// mailboxes are full: try again after the next frame was sent.
  [[nodiscard]] virtual bool send(const CanFrame& frame) = 0;
  /// Sets the owner's node id; 0, as before the first call: none. The controller may discard frames to other nodes:
  /// RPDO1, SDO and all others that have the node id in their identifier.
  virtual void set_node(std::uint8_t /*node*/) {}
  /// Selects the state frames (0x181 to 0x1FF, 0x281 to 0x2FF) that the owner needs; before the first call it needs
  /// none. The controller may discard other state frames.
  virtual void listen(std::span<const std::uint16_t> /*identifiers*/) {}
  /// Sets the node whose heartbeat the owner needs beside that of the host (0x77F); every_node: it needs all of them;
  /// 0, as before the first call: no other. The controller may discard other heartbeats (0x701 to 0x77F).
  virtual void expect_heartbeat(std::uint8_t /*node*/) {}
  static constexpr std::uint8_t every_node = 0xFF;
  /// Sets whether the owner needs all data frames with 11-bit identifiers, whatever set_node() and listen() say. Before
  /// the first call it does not. A gateway with a host on its line does.
  virtual void receive_all(bool /*all*/) {}
  /// The present error state of the controller.
  [[nodiscard]] virtual CanStatus status() { return {}; }
  /// Kinds of errors that the controller has seen since the last call; not necessarily all of them.
  [[nodiscard]] virtual CanErrors take_errors() { return {}; }
  /// Starts the recovery from bus-off (ISO 11898-1, 6.13). In bus-off the controller has stopped after too many errors
  /// and has dropped all waiting frames. The recovery takes 128 times 11 recessive bits. Controllers that recover by
  /// themselves ignore the call.
  virtual void recover() {}

 protected:
  ~CanPort() = default;
};

}  // namespace proleg
