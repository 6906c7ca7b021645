#pragma once

#include "firmware/module/parts.hpp"
#include "shared/canopen/sdo_server.hpp"

namespace proleg::firmware {

/// SDO abort code for what the kernel answers.
[[nodiscard]] canopen::AbortCode abort_code_of(Status status);

/// The object dictionary of the module: what stands behind each entry of shared/canopen/objects.hpp.
///
/// What a robot agrees on is written in Pre-operational and counts from `activate` on; parameters and limits are
/// written after that; parameters and internal values are staged in an open transaction at any time. Everything else is
/// refused with `refused_by_state`.
class DeviceObjects final : private canopen::ObjectAccess {
 public:
  explicit DeviceObjects(Parts& parts) : parts_(parts) {}

  void reset() { refusal_ = Status::ok; }

  /// Answers a frame on 0x600 + node.
  void serve(Microseconds now, const CanFrame& request);

  /// What the kernel answered to the last request that it refused; ok if it refused none.
  [[nodiscard]] Status refusal() const { return refusal_; }

 private:
  canopen::AbortCode read(const canopen::Object& object, std::uint32_t& value) override;
  canopen::AbortCode write(const canopen::Object& object, std::uint32_t value) override;

  [[nodiscard]] std::uint32_t read_device(canopen::Address address) const;
  [[nodiscard]] std::uint32_t read_joint(canopen::Address address) const;
  [[nodiscard]] std::uint32_t read_frame(unsigned joint, unsigned channel, std::uint8_t sub) const;
  canopen::AbortCode read_value(const canopen::ValueAddress& address, std::uint32_t& value) const;

  canopen::AbortCode write_sync_identifier(std::uint32_t value);
  canopen::AbortCode write_setting(canopen::Address address, std::uint32_t value);
  canopen::AbortCode write_algorithm(unsigned slot, std::uint32_t id);
  canopen::AbortCode write_limits(const canopen::AngleLimits& limits);
  canopen::AbortCode activate(bool active);
  canopen::AbortCode write_value(const canopen::ValueAddress& address, std::int32_t value);
  /// The abort code; keeps what was refused.
  canopen::AbortCode answer(Status status);

  Parts& parts_;
  Microseconds now_ = 0;  ///< of the request that is served
  Status refusal_ = Status::ok;
};

}  // namespace proleg::firmware
