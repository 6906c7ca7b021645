#pragma once

// Everything that the modules of a robot must be told before they move, and the SDO writes that tell it. There is no
// other way into a module: the loop and the host send the same list.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/canopen/object.hpp"
#include "shared/kernel/kernel.hpp"

namespace proleg::canopen {

/// A parameter of a joint that differs from its default.
struct StartValue {
  std::uint8_t slot;
  std::uint8_t joint;
  std::uint8_t parameter;
  std::int32_t value;
};

struct AngleLimits {
  std::int32_t lower;  ///< 90 degrees = 2^30
  std::int32_t upper;
};

/// Silence of the host after which a module stops, and the period of a module's own heartbeat.
inline constexpr std::uint32_t host_time_out_ms = 500;
inline constexpr std::uint32_t heartbeat_period_ms = 100;

/// A robot on a bus. Spans are in kernel order, one element a joint, but start_values.
struct RobotSetup {
  KernelConfiguration kernel;
  std::uint16_t robot_id = 1;
  std::uint32_t servo_period_us = 20'000;
  std::span<const std::uint8_t> nodes;  ///< node id of the module of each joint, each another one
  std::span<const AngleLimits> limits;
  std::span<const StartValue> start_values;  ///< of equal addresses the last one counts
};

/// What all modules of a robot must agree on; sent in TICK, read back after set-up. CRC-32 (shared/fixed/crc32.hpp) of,
/// little-endian and without gaps: u8 joint count, u32 tick period, u32 servo period, u64 seed, u16 robot id; for each
/// of the four slots u8 algorithm id and u64 group, both 0 if the slot is empty; for each joint u8 node id. Limits and
/// start values do not enter: they are a joint's own, and change in flight. A module knows all of it: the nodes of
/// other joints are in the identifiers of the state frames it listens to.
[[nodiscard]] std::uint32_t configuration_crc(const RobotSetup& setup);

struct SdoWrite {
  Address address;
  std::uint8_t size;  ///< bytes
  std::uint32_t value;

  friend bool operator==(const SdoWrite&, const SdoWrite&) = default;
};

/// The writes that make a module in Pre-operational, fresh from a reset, the one of a joint, in the order in which they
/// must be made: heartbeats, what the kernel needs, `activate`, then limits and parameters. What is at its default
/// after the reset and may stay so is not written.
///
/// setup: must outlive the list. The list is empty if there is no such joint, or if nodes or limits are missing. A
/// start value that fits no parameter of an algorithm that drives the joint is left out.
class SetupList {
 public:
  SetupList(const RobotSetup& setup, unsigned joint);

  [[nodiscard]] std::size_t size() const { return size_; }
  /// position: below size().
  [[nodiscard]] SdoWrite at(std::size_t position) const;

 private:
  using Values = std::array<std::array<std::int32_t, max_parameters>, max_slots>;

  void collect_start_values();
  template <typename Visitor>
  void visit_all(Visitor& visitor) const;

  const RobotSetup& setup_;
  unsigned joint_;
  JointMask second_channel_;
  Values start_values_{};
  std::array<std::uint32_t, max_slots> to_write_{};  ///< of each slot, bit p: parameter p differs from its default
  std::size_t size_ = 0;
};

}  // namespace proleg::canopen
