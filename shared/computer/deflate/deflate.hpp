#pragma once

#include <string>
#include <string_view>

namespace proleg {

/// Compresses bytes to the zlib format (RFC 1950), which browsers and Python read. Throws std::bad_alloc.
[[nodiscard]] std::string deflate(std::string_view bytes);

/// Encodes bytes with base64 (RFC 4648), with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace proleg
