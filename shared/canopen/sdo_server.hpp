#pragma once

// The server of expedited SDO transfers (CiA 301, section 7.2.4.3): four bytes at most, one request, one answer.

#include <optional>

#include "shared/can/can_port.hpp"
#include "shared/canopen/object.hpp"

namespace proleg::canopen {

/// The state of the device behind the SDO server. The server calls it only for entries that exist and have no
/// fixed_value(). Values to write have passed the checks of access rights, size and declared range. They have 32 bits;
/// signed types are sign-extended. The server sends the low bytes of a value that was read.
class ObjectAccess {
 public:
  virtual AbortCode read(const Entry& object, std::uint32_t& value) = 0;
  virtual AbortCode write(const Entry& object, std::uint32_t value) = 0;

 protected:
  ~ObjectAccess() = default;
};

/// Answers one request: a frame on 0x600 + node with any content. Returns nothing, without an effect, for a frame with
/// another identifier or length and for an abort of the client.
/// Segmented and block transfers are refused with `unknown_command`.
[[nodiscard]] std::optional<CanFrame> serve_sdo(std::uint8_t node, const CanFrame& request, ObjectAccess& device);

}  // namespace proleg::canopen
