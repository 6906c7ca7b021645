#include "tools/proleg/document/useful_range.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string_view>

namespace proleg::tools {
namespace {

struct Known {
  std::string_view name;
  Unit unit;
  UsefulRange range;
};

constexpr UsefulRange range(Unit unit, std::int32_t lower, std::int32_t upper) {
  return {raw(unit, lower), raw(unit, upper)};
}

constexpr UsefulRange amplitudes = range(Unit::degree, 0, 60);
/// A servo that turns 60 degrees in 0.2 s follows an amplitude of 40 degrees up to about 1.2 Hz.
constexpr UsefulRange frequencies{raw(Unit::hertz, 1, 10), raw(Unit::hertz, 2)};
constexpr UsefulRange phase_differences = range(Unit::phase_degree, -120, 120);
constexpr UsefulRange offsets = range(Unit::degree, -45, 45);
/// Degrees in 10 ms.
constexpr UsefulRange bending_speeds = range(Unit::degree, 0, 5);

constexpr Known known[] = {
    {"amplitude", Unit::degree, amplitudes},
    {"pitch_amplitude", Unit::degree, amplitudes},
    {"yaw_amplitude", Unit::degree, amplitudes},
    {"winding_angle", Unit::degree, amplitudes},
    {"max_offset", Unit::degree, amplitudes},
    {"frequency", Unit::hertz, frequencies},
    {"pitch_frequency", Unit::hertz, frequencies},
    {"yaw_frequency", Unit::hertz, frequencies},
    {"phase_difference", Unit::phase_degree, phase_differences},
    {"pitch_phase_difference", Unit::phase_degree, phase_differences},
    {"yaw_phase_difference", Unit::phase_degree, phase_differences},
    {"offset", Unit::degree, offsets},
    {"pitch_offset", Unit::degree, offsets},
    {"yaw_offset", Unit::degree, offsets},
    {"turn", Unit::degree, offsets},
    {"raise", Unit::degree, offsets},
    {"amplitude_slope", Unit::degree, range(Unit::degree, -5, 5)},
    {"waves", Unit::ratio, range(Unit::ratio, -2, 2)},
    {"harmonic", Unit::count, {1, 4}},
    {"noise", Unit::ratio, range(Unit::ratio, 0, 2)},
    {"rate", Unit::per_second, range(Unit::per_second, 2, 40)},
    {"coupling", Unit::per_second, range(Unit::per_second, 0, 20)},
    {"attraction", Unit::per_second, range(Unit::per_second, 2, 25)},
    {"reach", Unit::count, {0, 8}},
    {"confirm", Unit::count, {1, 20}},
    {"hold", Unit::count, {0, 1'000}},
    {"retreat", Unit::count, {0, 1'000}},
    {"stuck_threshold", Unit::count, {50, 1'000}},
    {"give_up", Unit::count, {1'000, 30'000}},
    {"recovering", Unit::degree, bending_speeds},
    {"constant_1", Unit::degree, bending_speeds},
    {"constant_2", Unit::degree, bending_speeds},
    {"constant_3", Unit::degree, bending_speeds},
    {"constant_4", Unit::degree, bending_speeds},
    {"constant_5", Unit::degree, bending_speeds},
    {"constant_6", Unit::degree, bending_speeds},
    {"constant_7", Unit::degree, bending_speeds},
    {"constant_8", Unit::degree, bending_speeds},
};

}  // namespace

UsefulRange useful_range(const Parameter& parameter) {
  const UsefulRange whole{parameter.minimum, parameter.maximum};
  const auto* const found = std::ranges::find_if(
      known, [&](const Known& entry) { return entry.name == parameter.name && entry.unit == parameter.unit; });
  if (found == std::end(known)) {
    return whole;
  }
  const UsefulRange within{std::max(found->range.lower, whole.lower), std::min(found->range.upper, whole.upper)};
  return within.lower < within.upper ? within : whole;
}

}  // namespace proleg::tools
