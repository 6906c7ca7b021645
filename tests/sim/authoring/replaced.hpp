#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace proleg::sim {

/// The text with the first `from`, which it must contain, replaced.
[[nodiscard]] inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace proleg::sim
