#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace proleg::sim {

/// "0x4C", for messages.
[[nodiscard]] inline std::string hexadecimal(std::uint32_t value) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string text;
  do {
    text.insert(text.begin(), digits[value % 16]);
    value /= 16;
  } while (value != 0);
  return "0x" + text;
}

}  // namespace proleg::sim
