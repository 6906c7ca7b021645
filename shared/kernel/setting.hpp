#pragma once

#include <cstdint>

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

}  // namespace proleg
