#include "sim/scenario/file_source.hpp"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <system_error>

#include "shared/computer/errors/file_kind.hpp"

namespace proleg::sim {

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

}  // namespace proleg::sim
