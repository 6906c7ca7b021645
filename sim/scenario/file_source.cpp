#include "sim/scenario/file_source.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::sim {
namespace {

constexpr std::string_view head = "data:application/octet-stream;base64,";
constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr unsigned digit_bits = 6;
constexpr std::size_t group_digits = 4;
constexpr std::size_t group_bytes = 3;

}  // namespace

std::optional<std::string> DiskFiles::read(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return std::nullopt;
  }
  if (const auto size = std::filesystem::file_size(path, error); error || size > max_file_bytes) {
    return std::nullopt;
  }
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  if (stream.peek() != std::ifstream::traits_type::eof()) {
    text << stream.rdbuf();
  }
  if (stream.bad() || !stream.is_open()) {
    return std::nullopt;
  }
  return std::move(text).str();
}

std::optional<std::string> DiskFiles::found_instead(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return std::nullopt;
  }
  if (const std::optional<std::string> found = found_instead_of_file(path)) {
    return found;
  }
  constexpr std::uintmax_t mebibyte = 1U << 20U;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return !error && size > max_file_bytes ? "a file of " + std::to_string((size + mebibyte - 1) / mebibyte) + " MiB"
                                         : "a file that cannot be read";
}

std::string data_url(std::string_view bytes) {
  std::string text(head);
  for (std::size_t at = 0; at < bytes.size(); at += group_bytes) {
    const std::string_view group = bytes.substr(at, group_bytes);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < group_bytes; ++i) {
      bits = bits << 8U | (i < group.size() ? static_cast<std::uint8_t>(group[i]) : 0U);
    }
    for (std::size_t i = 0; i < group_digits; ++i) {
      const auto shift = static_cast<unsigned>(group_digits - 1 - i) * digit_bits;
      text += i <= group.size() ? digits[bits >> shift & 63U] : '=';
    }
  }
  return text;
}

std::string bytes_of_source(const std::string& text) {
  if (!text.starts_with(head)) {
    return text;
  }
  std::string bytes;
  std::uint32_t bits = 0;
  unsigned count = 0;
  for (const char character : std::string_view(text).substr(head.size())) {
    const std::size_t digit = digits.find(character);
    if (digit == std::string_view::npos) {
      break;  // "=" at the end
    }
    bits = bits << digit_bits | static_cast<std::uint32_t>(digit);
    count += digit_bits;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 0xFFU);
    }
  }
  return bytes;
}

std::size_t size_of_source(std::string_view text) {
  if (!text.starts_with(head)) {
    return text.size();
  }
  const std::string_view encoded = text.substr(head.size());
  return std::min(encoded.size(), encoded.find('=')) * group_bytes / group_digits;
}

}  // namespace proleg::sim
