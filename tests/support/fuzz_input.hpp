#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

namespace proleg::test {

/// For fuzz targets: ends the program if a rule does not hold.
inline void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

/// The input of a fuzz target, byte by byte; 0 when it is used up.
class FuzzInput {
 public:
  explicit FuzzInput(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  std::uint8_t byte() {
    if (bytes_.empty()) {
      return 0;
    }
    const std::uint8_t value = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return value;
  }
  /// Little-endian.
  std::uint16_t half() {
    const std::uint8_t low = byte();
    return static_cast<std::uint16_t>(low | byte() << 8U);
  }
  std::uint32_t word() {
    const std::uint16_t low = half();
    return low | std::uint32_t{half()} << 16U;
  }
  template <std::size_t size>
  std::array<std::uint8_t, size> take() {
    std::array<std::uint8_t, size> data{};
    for (std::uint8_t& value : data) {
      value = byte();
    }
    return data;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace proleg::test
