#pragma once

// The declaration of an algorithm: its parameters, its internal values and what it broadcasts. The command line, the
// scenario reader, recordings, documentation and the object dictionary take names, units, ranges and layout from here.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "shared/fixed/unit.hpp"

namespace proleg {

/// Capacities of one slot on one joint.
inline constexpr std::size_t max_parameters = 32;
inline constexpr std::size_t max_derived = 12;
inline constexpr std::size_t max_internal_values = 20;

/// Name of the parameter that PatternGenerator multiplies the noise of the start state by.
inline constexpr std::string_view noise_name = "noise";

// Text for programs on a computer. The image of a module has none: nothing in it reads the text, and its memory is
// small. Of the names of parameters it has what PatternGenerator asks.
#ifdef __arm__
struct HostText {
  constexpr HostText(const char* /*text*/) {}                 // implicit, as it is in std::string_view on the host
  constexpr operator std::string_view() const { return {}; }  // NOLINT(google-explicit-constructor)
};
struct ParameterName : HostText {
  bool is_noise;
  constexpr ParameterName(const char* text) : HostText(text), is_noise(std::string_view(text) == noise_name) {}
};
[[nodiscard]] constexpr bool is_noise(const ParameterName& name) { return name.is_noise; }
#else
using HostText = std::string_view;
using ParameterName = std::string_view;
[[nodiscard]] constexpr bool is_noise(ParameterName name) { return name == noise_name; }
#endif

/// A value that a user sets, uniform over the joints of a slot or for each joint.
struct Parameter {
  ParameterName name;
  Unit unit;
  std::int32_t default_value;
  std::int32_t minimum;
  std::int32_t maximum;
  [[no_unique_address]] HostText
      help;  ///< what it changes: an everyday sentence, which the page shows below the name; then details
};

/// A value that the algorithm computes: its state, or a measurement of it.
struct InternalValue {
  [[no_unique_address]] HostText name;
  Unit unit;
  /// Standard deviation, in raw steps, of the noise that a pattern generator adds at reset when its parameter `noise`
  /// is 1; 0 for values that start without noise.
  std::int32_t noise_scale;
  [[no_unique_address]] HostText help;
};

/// A part of the state frame: the leading bytes of an internal value, little-endian. A value with unit `count` sends
/// its low bytes instead.
struct FrameField {
  std::uint8_t internal_value;  ///< index into Declaration::internal_values
  std::uint8_t bytes;           ///< 1 to 4
};

/// The lowest id of algorithms outside of this tree (docs/user-algorithms.md). The core uses no id from here on.
inline constexpr std::uint8_t first_user_id = 96;
inline constexpr std::uint8_t last_user_id = 126;
inline constexpr std::size_t max_user_algorithms = last_user_id - first_user_id + 1;

/// Two parameters whose values cannot be meant together.
struct Contradiction {
  std::uint8_t parameter;
  std::uint8_t other;
  HostText expected;  ///< what would be right, for a message
};

/// What parameters that depend on each other mean together. Only hosts ask for it.
struct ParameterRules {
  /// values: of all parameters of one joint.
  std::optional<Contradiction> (*contradiction)(const std::int32_t* values);
  /// The sensors that the algorithm needs with these values: bits of JointReadings::Sensor. It uses the others of
  /// ActuationModule::senses_readings() no more than if they were absent.
  std::uint8_t (*required_readings)(const std::int32_t* values);
};

/// The image of a module has no rules.
#ifdef __arm__
struct HostRules {
  constexpr HostRules() = default;
  constexpr HostRules(const ParameterRules* /*rules*/) {}  // implicit, as a pointer is on the host
};
#else
using HostRules = const ParameterRules*;
#endif

struct Declaration {
  std::uint8_t id;  ///< 1 to 127, never reused: object dictionary index 0x3000 + 32 id + parameter number
  HostText name;
  HostText help;
  std::span<const Parameter> parameters;
  std::span<const InternalValue> internal_values;
  std::span<const FrameField> frame;  ///< at most 6 bytes; empty if nothing is broadcast
  /// The first 32 bits of the SHA-256 of the sources of a user's algorithm (tools/cmake/user_algorithm.cmake). Programs
  /// with equal numbers compute with the same sources. 0 in the core, whose fingerprint identifies its sources.
  std::uint32_t sources = 0;
  HostRules rules{};  ///< null: every value is possible with every other, and all sensors are needed
};

[[nodiscard]] constexpr bool is_user_algorithm(std::uint8_t id) { return id >= first_user_id && id <= last_user_id; }

/// Position of the item with this name, or -1.
template <typename Named>
[[nodiscard]] constexpr int find_by_name(std::span<const Named> items, std::string_view name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) {
      return static_cast<int>(i);
    }
  }
  return -1;
}
/// Position of the parameter or internal value with this name, or -1.
[[nodiscard]] constexpr int find_parameter(const Declaration& declaration, std::string_view name) {
  return find_by_name(declaration.parameters, name);
}
[[nodiscard]] constexpr int find_internal_value(const Declaration& declaration, std::string_view name) {
  return find_by_name(declaration.internal_values, name);
}

/// The ends of the range of a phase, which is all of int32_t.
inline constexpr std::int32_t phase_minimum = std::numeric_limits<std::int32_t>::min();
inline constexpr std::int32_t phase_maximum = std::numeric_limits<std::int32_t>::max();

/// 90 degrees, the maximal joint angle (thesis, table 3.1).
inline constexpr std::int32_t quarter_turn = 1 << 30;

}  // namespace proleg
