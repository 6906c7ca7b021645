#pragma once

#include <string>
#include <string_view>

namespace proleg {

/// The bytes in zlib format (RFC 1950), as browsers and Python read it. Throws std::bad_alloc.
[[nodiscard]] std::string deflate(std::string_view bytes);

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace proleg
