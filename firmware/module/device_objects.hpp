#pragma once

#include "firmware/module/object_accessors.hpp"
#include "shared/canopen/sdo_server.hpp"

namespace proleg::firmware {

/// Reads a declared entry. `unsupported_access` if the table has no row for it.
[[nodiscard]] canopen::AbortCode read_object(std::span<const ObjectAccessor> accessors, const Parts& parts,
                                             canopen::Address address, std::uint32_t& value);
/// Writes a declared entry with a value that has passed the declared range; the same.
[[nodiscard]] canopen::AbortCode write_object(std::span<const ObjectAccessor> accessors, Parts& parts,
                                              canopen::Address address, std::uint32_t value, Microseconds now);

/// The SDO server of the module's object dictionary: what object_accessors() has, as it is when a request comes.
///
/// The host writes what a robot agrees on in Pre-operational; it takes effect at `activate`. After that it writes
/// parameters and limits. In an open transaction it stages parameters and internal values in any state.
class DeviceObjects final : private canopen::ObjectAccess {
 public:
  explicit DeviceObjects(Parts& parts) : parts_(parts) {}

  /// Answers a frame on 0x600 + node.
  void serve(Microseconds now, const CanFrame& request);

 private:
  canopen::AbortCode read(const canopen::Entry& object, std::uint32_t& value) override;
  canopen::AbortCode write(const canopen::Entry& object, std::uint32_t value) override;

  Parts& parts_;
  Microseconds now_ = 0;  ///< of the request that is served
};

}  // namespace proleg::firmware
