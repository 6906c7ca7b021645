#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/gait/declaration.hpp"

namespace proleg {

/// The state frame of a joint (docs/protocol.md): all that other joints receive from it, on the bus and in memory.
///
/// bytes 0-5: what the algorithm declares as its frame, in that order; byte 6: contacts and flags; byte 7: label, the
/// tick of the state modulo 256.
struct alignas(4) StateFrame {  // copied as two words; single bytes would need a library call
  static constexpr std::size_t payload_size = 6;

  std::array<std::uint8_t, 8> bytes{};

  enum Flag : std::uint8_t {
    contact_rear_link_rear = 1U << 0U,   ///< link behind the joint, sensor nearer to the tail
    contact_rear_link_front = 1U << 1U,  ///< link behind the joint, sensor nearer to the head
    contact_far_link_rear = 1U << 2U,    ///< link in front of joint 0 (head module only), sensor nearer to the tail
    contact_far_link_front = 1U << 3U,   ///< link in front of joint 0 (head module only), sensor nearer to the head
    fault = 1U << 4U,
    holdover = 1U << 5U,  ///< the joint computes without receiving SYNC
    limited = 1U << 6U,   ///< the sum of the slots was cut to the joint's limits
    valid = 1U << 7U,     ///< the joint computes; bytes 0-5 are its state, or 0 if it broadcasts nothing
  };
  static constexpr std::uint8_t rear_link_contact_bits = 0x03;
  static constexpr std::uint8_t contact_bits = 0x0F;

  [[nodiscard]] std::uint8_t flags() const { return bytes[6]; }
  [[nodiscard]] std::uint8_t label() const { return bytes[7]; }

  friend bool operator==(const StateFrame&, const StateFrame&) = default;
};

/// Writes the declared fields of a state into bytes 0-5. Angles are rounded half up and saturate, phases are rounded
/// and wrap, counts saturate at the width of their field.
void pack(const Declaration& declaration, const std::int32_t* internal_values, StateFrame& frame);

/// Reads one declared field, as an internal value with its low bits 0. field: index into declaration.frame.
[[nodiscard]] std::int32_t unpack(const Declaration& declaration, std::size_t field, const StateFrame& frame);

/// Overwrites one declared field. field: index into declaration.frame.
void repack(const Declaration& declaration, std::size_t field, std::int32_t value, StateFrame& frame);

}  // namespace proleg
