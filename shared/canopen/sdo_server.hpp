#pragma once

// The server of expedited SDO transfers (CiA 301, section 7.2.4.3): four bytes at most, one request, one answer.

#include <optional>

#include "shared/can/can_port.hpp"
#include "shared/canopen/object.hpp"

namespace proleg::canopen {

/// The state of a device that stands behind the SDO server. Called only for entries that exist and are not settled by
/// their declaration (fixed_value), with values that have passed access rights, size and declared range, as 32 bits:
/// signed types are sign-extended. Of a value read, the low bytes count.
class ObjectAccess {
 public:
  virtual AbortCode read(const Object& object, std::uint32_t& value) = 0;
  virtual AbortCode write(const Object& object, std::uint32_t value) = 0;

 protected:
  ~ObjectAccess() = default;
};

/// Answers one request. request: a frame on 0x600 + node, of any content. Nothing is returned, and nothing happens, for
/// a frame with another identifier or length and for an abort of the client.
/// Segmented and block transfers are refused with `unknown_command`.
[[nodiscard]] std::optional<CanFrame> serve_sdo(std::uint8_t node, const CanFrame& request, ObjectAccess& device);

}  // namespace proleg::canopen
