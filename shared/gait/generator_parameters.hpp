#pragma once

// Parameters and internal values that several pattern generators share. The ranges are those of thesis, table 3.1. The
// defaults are the travelling wave of thesis section 6.1 at 1 Hz, which its servo allows.

#include "shared/gait/declaration.hpp"

namespace proleg::generator_parameters {

inline constexpr Parameter amplitude{"amplitude", Unit::degree, raw(Unit::degree, 40),
                                     0,           quarter_turn, "How far the joint swings to each side."};
inline constexpr Parameter frequency{"frequency", Unit::hertz,          raw(Unit::hertz, 1),
                                     0,           raw(Unit::hertz, 20), "How many times the joint swings in a second."};
inline constexpr Parameter phase_difference{
    "phase_difference",
    Unit::phase_degree,
    raw(Unit::phase_degree, 55),
    phase_minimum,
    phase_maximum,
    "How far the wave runs ahead from joint to joint. Phase of a joint minus phase of the joint in front of it in the "
    "whole chain, whatever moves that one."};
inline constexpr Parameter phase{
    "phase",       Unit::phase_degree, 0,
    phase_minimum, phase_maximum,      "How far this joint is ahead of its place in the wave. Added to its phase."};
inline constexpr Parameter offset{"offset",      Unit::degree, 0,
                                  -quarter_turn, quarter_turn, "The angle around which the joint swings."};
inline constexpr Parameter rate{
    "rate",
    Unit::per_second,
    raw(Unit::per_second, 20),
    raw(Unit::per_second, 1, 10),
    raw(Unit::per_second, 100),
    "How fast a changed value takes effect. Rate a of the critically damped filters; 95 % of a change takes 9.49/a."};

/// Factor for the noise at reset; the default differs between algorithms.
[[nodiscard]] constexpr Parameter noise(std::int32_t default_value) {
  return {noise_name.data(),   Unit::ratio,
          default_value,       0,
          raw(Unit::ratio, 4), "How irregular the start is. Factor on the noise of the start state."};
}

}  // namespace proleg::generator_parameters

namespace proleg::generator_values {

/// An amplitude or an offset that follows its parameter; its rate is the next internal value (critical_filter.hpp).
/// noise_scale: of the start state.
[[nodiscard]] constexpr InternalValue current_amplitude(std::int32_t noise_scale = 0) {
  return {"current_amplitude", Unit::degree, noise_scale, "filtered amplitude"};
}
inline constexpr InternalValue amplitude_rate{"amplitude_rate", Unit::degree, 0,
                                              "its change in a second, times 2 / rate"};
[[nodiscard]] constexpr InternalValue current_offset(std::int32_t noise_scale = 0) {
  return {"current_offset", Unit::degree, noise_scale, "filtered offset"};
}
inline constexpr InternalValue offset_rate{"offset_rate", Unit::degree, 0, "its change in a second, times 2 / rate"};

}  // namespace proleg::generator_values
