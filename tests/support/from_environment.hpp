#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace proleg {

/// A number that the environment gives a test: how many random runs, and which.
inline std::uint32_t from_environment(const char* name, std::uint32_t fallback) {
  const char* text = std::getenv(name);
  return text == nullptr ? fallback : static_cast<std::uint32_t>(std::stoul(text));
}

}  // namespace proleg
