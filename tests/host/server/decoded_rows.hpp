#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace proleg::host {

/// A binary message, read byte by byte as docs/page-interface.md describes it.
struct DecodedRows {
  explicit DecodedRows(const std::string& bytes)
      : subscription(number(bytes, 0, 4)),
        tick(number(bytes, 4, 4)),
        rows(number(bytes, 8, 2)),
        stride(number(bytes, 10, 2)),
        run(number(bytes, 12, 2)),
        flags(number(bytes, 14, 2)) {
    for (std::size_t at = 16; at + 4 <= bytes.size(); at += 4) {
      values.push_back(static_cast<std::int32_t>(number(bytes, at, 4)));
    }
  }

  static std::uint32_t number(const std::string& bytes, std::size_t at, std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t i = size; i-- > 0;) {
      value = value << 8U | static_cast<unsigned char>(bytes.at(at + i));
    }
    return value;
  }

  std::uint32_t subscription;
  std::uint32_t tick;
  std::uint32_t rows;
  std::uint32_t stride;
  std::uint32_t run;
  std::uint32_t flags;
  std::vector<std::int32_t> values;
};

}  // namespace proleg::host
