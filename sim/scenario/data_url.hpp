#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace proleg::sim {

/// Bytes as text, for sources that are no text, such as a binary STL file: "data:application/octet-stream;base64,..."
/// (RFC 2397).
[[nodiscard]] std::string data_url(std::string_view bytes);

/// The bytes of a source: those of a text that data_url() made, otherwise the text itself.
[[nodiscard]] std::string bytes_of_source(const std::string& text);
/// Their number.
[[nodiscard]] std::size_t size_of_source(std::string_view text);

}  // namespace proleg::sim
