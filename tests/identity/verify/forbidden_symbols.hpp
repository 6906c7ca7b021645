#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::verify {

/// What the object file of an algorithm for Cortex-M uses although the core may not: floating point, the heap, other
/// functions that a module does not have or that do not give the same bits, and variables that keep a value. One phrase
/// for each. listing: what `nm -C` prints.
[[nodiscard]] std::vector<std::string> forbidden_symbols(std::string_view listing);

/// Code and constants of an object file, in bytes: what it takes of the flash. sizes: what `size` prints. Nothing if
/// that has another form.
[[nodiscard]] std::optional<std::uint32_t> flash_bytes(std::string_view sizes);

}  // namespace proleg::verify
