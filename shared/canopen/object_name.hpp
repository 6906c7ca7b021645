#pragma once

// Names of entries that people read, in messages, the EDS and docs/objects.md.

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

/// Name of an index, such as "Identity object", "Controlword" or "PatternGenerator_sinusoidal amplitude, staged"; empty
/// if the index is absent.
[[nodiscard]] ObjectName index_name(std::uint16_t index);
/// Name of an entry within its index, such as "Vendor-ID", "Controlword" or "amplitude, staged, of slot 2"; empty if
/// the entry is absent.
[[nodiscard]] ObjectName entry_name(Address address);
/// Names of index and entry, such as "Identity object: Vendor-ID", "Controlword" or "PatternGenerator_sinusoidal
/// amplitude, staged: slot 2"; empty if the entry is absent.
[[nodiscard]] ObjectName full_name(Address address);

}  // namespace proleg::canopen
