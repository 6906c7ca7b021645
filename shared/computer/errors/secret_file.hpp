#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace proleg {

/// What to warn of if others than its owner can read a file with a key or another secret: one line; nothing if not, or
/// if there is no such file.
[[nodiscard]] std::optional<std::string> warning_on_secret(const std::filesystem::path& file);

}  // namespace proleg
