#pragma once

// Frames as docs/protocol.md and candump write them: "183 [8] 8E E3 38 4E 72 1C 83 2C".

#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <string_view>

#include "shared/can/can_frame.hpp"
#include "tests/support/files.hpp"

namespace proleg::test {

inline CanFrame frame(const std::string& text) {
  std::istringstream in(text);
  unsigned identifier = 0;
  unsigned length = 0;
  char bracket = 0;
  in >> std::hex >> identifier >> bracket >> length >> bracket;
  CanFrame result{static_cast<std::uint16_t>(identifier), static_cast<std::uint8_t>(length), {}};
  for (unsigned i = 0; i < length; ++i) {
    unsigned byte = 0;
    in >> byte;
    result.data[i] = static_cast<std::uint8_t>(byte);
  }
  return result;
}

inline std::string text(const CanFrame& frame) {
  char part[16];
  std::snprintf(part, sizeof part, "%03X [%u]", unsigned{frame.identifier}, unsigned{frame.length});
  std::string result = part;
  for (const std::uint8_t byte : frame.bytes()) {
    std::snprintf(part, sizeof part, " %02X", unsigned{byte});
    result += part;
  }
  return result;
}

/// Whether docs/protocol.md has the frame as a worked example.
inline bool is_documented(std::string_view frame) {
  std::ifstream file(source_path("/docs/protocol.md"));
  std::string line;
  while (std::getline(file, line)) {
    if (line == "    " + std::string(frame)) {
      return true;
    }
  }
  return false;
}

/// A well-formed frame with random length and data.
inline CanFrame random_frame(std::mt19937& random, std::uint16_t identifier) {
  CanFrame frame{identifier, static_cast<std::uint8_t>(random() % 4 == 0 ? random() % 9 : 8), {}};
  for (unsigned i = 0; i < frame.length; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(random());
  }
  return frame;
}

}  // namespace proleg::test

namespace proleg {
inline void PrintTo(const CanFrame& frame, std::ostream* out) { *out << test::text(frame); }
}  // namespace proleg
