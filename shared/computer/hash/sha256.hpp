#pragma once

#include <span>
#include <string>
#include <string_view>

namespace proleg {

/// SHA-256 of the bytes of a text, 64 lower-case hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::string_view text);

/// Writes bytes as lower-case hexadecimal digits, two for each byte.
[[nodiscard]] std::string hexadecimal_digits(std::span<const unsigned char> bytes);

}  // namespace proleg
