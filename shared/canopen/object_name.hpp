#pragma once

// Names of entries for people: messages, the EDS, docs/objects.md.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "shared/canopen/object.hpp"

namespace proleg::canopen {

struct ObjectName {
  std::array<char, 128> characters;
  std::size_t size;

  [[nodiscard]] std::string_view view() const { return {characters.data(), size}; }
};

/// "Identity object", "Controlword", "PatternGenerator_sinusoidal amplitude, staged"; empty if there is no such index.
[[nodiscard]] ObjectName index_name(std::uint16_t index);
/// "Vendor-ID", "Controlword", "amplitude, staged, of slot 2"; empty if there is no such entry.
[[nodiscard]] ObjectName entry_name(Address address);
/// "Identity object: Vendor-ID", "Controlword", "PatternGenerator_sinusoidal amplitude, staged: slot 2"; empty if there
/// is no such entry.
[[nodiscard]] ObjectName full_name(Address address);

}  // namespace proleg::canopen
