#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace proleg::tools {

inline constexpr std::uint32_t max_workers = 1024;

/// Parses --workers; by default one for each processor. Throws InputError.
[[nodiscard]] std::uint32_t parse_workers(const std::optional<std::string>& word);

}  // namespace proleg::tools
