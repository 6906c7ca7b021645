#pragma once

// The layer setting services (LSS, CiA 305), for slave and master: every frame has 8 bytes, the first is the service.

#include <array>

#include "shared/can/can_frame.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::canopen {

/// Identity of a module in LSS: vendor, product, revision and serial number, as in object 0x1018.
using LssAddress = std::array<std::uint32_t, 4>;

namespace lss {

/// Command specifiers.
enum class Service : std::uint8_t {
  switch_state_global = 0x04,
  configure_node_id = 0x11,
  configure_bit_timing = 0x13,
  activate_bit_timing = 0x15,
  store_configuration = 0x17,
  select_vendor = 0x40,  ///< 0x40 to 0x43: a number of the address each
  select_serial = 0x43,
  selected = 0x44,  ///< answer to select_serial
  /// 0x46 to 0x4B: vendor, product, the limits of the revision, the limits of the serial number.
  identify_vendor = 0x46,
  identify_serial_high = 0x4B,
  identify_non_configured = 0x4C,
  identified = 0x4F,                 ///< answer to identify_serial_high and fastscan
  identified_non_configured = 0x50,  ///< answer to identify_non_configured
  fastscan = 0x51,
  inquire_vendor = 0x5A,  ///< 0x5A to 0x5D: a number of the address each
  inquire_serial = 0x5D,
  inquire_node_id = 0x5E,
};

/// States of a slave that switch_state_global selects.
enum class State : std::uint8_t { waiting = 0, configuration = 1 };

/// Error codes in the answers to configure_node_id, configure_bit_timing and store_configuration.
inline constexpr std::uint8_t ok = 0;
inline constexpr std::uint8_t not_supported = 1;  ///< the node id or the bit timing is impossible, or storing is
inline constexpr std::uint8_t storage_failed = 2;
inline constexpr std::uint8_t specific_error = 0xFF;  ///< the next byte has the error
/// The byte that follows specific_error: the module moves its servo, or is Operational.
inline constexpr std::uint8_t refused_by_state = 1;

/// The node id of a module without one.
inline constexpr std::uint8_t no_node_id = 0xFF;

/// Number of 1 Mbit/s in table 0 of the bit timings.
inline constexpr std::uint8_t standard_table = 0;
inline constexpr std::uint8_t timing_1_mbit = 0;

/// The bit number in a request of Fastscan with which all slaves without a node id begin.
inline constexpr std::uint8_t fastscan_start = 0x80;

/// Service of a frame.
[[nodiscard]] constexpr Service service_of(const CanFrame& frame) { return static_cast<Service>(frame.data[0]); }

/// Makes a frame with bytes 1 and 2; the rest is 0.
[[nodiscard]] constexpr CanFrame make(std::uint16_t identifier, Service service, std::uint8_t first = 0,
                                      std::uint8_t second = 0) {
  return {identifier, 8, {static_cast<std::uint8_t>(service), first, second}};
}
/// Makes a frame with bytes 1 to 4; the rest is 0.
[[nodiscard]] constexpr CanFrame make_word(std::uint16_t identifier, Service service, std::uint32_t word) {
  CanFrame frame = make(identifier, service);
  write_little_endian(frame.data, 1, 4, word);
  return frame;
}
[[nodiscard]] constexpr std::uint32_t word_of(const CanFrame& frame) { return read_little_endian(frame.data, 1, 4); }

/// A request of Fastscan: it asks whether the bits of a number of the address, from `bit` upwards, are those of
/// `number`.
struct FastscanRequest {
  std::uint32_t number = 0;
  std::uint8_t bit = 0;   ///< 31 to 0, or fastscan_start
  std::uint8_t sub = 0;   ///< position of that number in the address, 0 to 3
  std::uint8_t next = 0;  ///< position of the number in the next request; if it is below `sub`, the slave is identified
};
[[nodiscard]] constexpr CanFrame encode(const FastscanRequest& request) {
  CanFrame frame = make_word(identifier::lss_request, Service::fastscan, request.number);
  frame.data[5] = request.bit;
  frame.data[6] = request.sub;
  frame.data[7] = request.next;
  return frame;
}
[[nodiscard]] constexpr FastscanRequest fastscan_of(const CanFrame& frame) {
  return {word_of(frame), frame.data[5], frame.data[6], frame.data[7]};
}

}  // namespace lss

}  // namespace proleg::canopen
