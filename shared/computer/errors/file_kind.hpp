#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace proleg {

/// What a path names instead of a file whose bytes can be read to an end, for "found ...": "a folder", "a device, a
/// pipe or a socket", "no such file", "an empty path", or why the system does not say. Nothing if it is a regular file,
/// or a link to one.
[[nodiscard]] std::optional<std::string> found_instead_of_file(const std::filesystem::path& path);

}  // namespace proleg
