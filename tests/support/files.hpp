#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace proleg {

/// Absolute path of a file of the source tree. `below` starts with a slash: source_path("/docs/protocol.md").
[[nodiscard]] std::string source_path(std::string_view below);

/// The bytes of a file; empty if it cannot be read.
[[nodiscard]] std::string file_contents(const std::filesystem::path& path);

}  // namespace proleg
