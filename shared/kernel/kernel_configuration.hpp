#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// "In this slot, on this joint, this parameter gets this value." From the reader of a file, a `--set` word or a slider
/// to the SDO that carries it, a value has this type.
struct Setting {
  std::uint8_t slot = 0;    ///< 0 to 3
  std::uint8_t joint = 0;   ///< kernel order
  std::uint8_t number = 0;  ///< number of the parameter or internal value: its position in the declaration
  bool internal = false;    ///< whether it sets an internal value (a distortion), not a parameter
  std::int32_t value = 0;   ///< raw (shared/fixed/unit.hpp)

  /// Whether both set the same parameter or internal value of the same joint.
  [[nodiscard]] constexpr bool has_same_place(const Setting& other) const {
    return slot == other.slot && joint == other.joint && number == other.number && internal == other.internal;
  }
};

/// Limits of the angle of a joint, 90 degrees = 2^30.
struct AngleLimits {
  std::int32_t lower = -(1 << 30);
  std::int32_t upper = 1 << 30;
};

inline constexpr std::size_t max_slots = 4;
/// Greatest number of state frames that a joint sends in a tick: one for each of its two broadcasting slots.
inline constexpr std::size_t max_channels = 2;

/// An algorithm on a group of joints.
struct Slot {
  const ActuationModule* algorithm = nullptr;  ///< null: the slot is empty
  JointMask group;

  /// Whether neighbours receive the algorithm's state.
  [[nodiscard]] bool broadcasts() const { return algorithm != nullptr && !algorithm->declaration().frame.empty(); }
  /// Id of the algorithm; 0 if the slot is empty.
  [[nodiscard]] std::uint8_t algorithm_id() const {
    return algorithm == nullptr ? std::uint8_t{0} : algorithm->declaration().id;
  }
  /// Joints that the slot drives: its group, or no joints if the slot is empty.
  [[nodiscard]] JointMask driven_joints() const { return algorithm == nullptr ? JointMask() : group; }
};

/// The configuration that the kernels of all joints must agree on.
struct KernelConfiguration {
  std::uint8_t joint_count = 0;
  std::uint32_t tick_period_us = 10'000;
  std::uint64_t seed = 1;  ///< seed of the noise at reset
  std::array<Slot, max_slots> slots;

  /// Joints that send the state of this slot in their second frame, because an earlier slot of theirs broadcasts, too.
  [[nodiscard]] JointMask second_channel(unsigned slot) const;
  /// Joints that send two state frames in a tick.
  [[nodiscard]] JointMask second_channel_senders() const;
};

}  // namespace proleg
