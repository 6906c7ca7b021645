#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "firmware/module/board_record.hpp"

namespace proleg::test {

using Sector = std::vector<std::uint8_t>;

struct PowerCut : std::runtime_error {
  PowerCut() : std::runtime_error("power cut") {}
};

/// NOR flash: words are programmed from 1 to 0, sectors are erased to 1. The power can fail at any operation, which
/// then is done in part.
class FlashMemory final : public firmware::FlashPort {
 public:
  /// The sectors are small, so that the log often returns to its start.
  static constexpr std::size_t sector_size = 4 * firmware::BoardRecord::size;

  std::array<Sector, 2> sectors{Sector(sector_size, 0xFF), Sector(sector_size, 0xFF)};
  int operations = 0;   ///< number of words programmed and sectors erased
  int cut_at = -1;      ///< the operation that does not end
  int refused_at = -1;  ///< the operation that reports an error
  std::mt19937 noise{20};

  bool erase(unsigned sector) override {
    const bool cut = operations == cut_at;
    if (operations++ == refused_at) {
      return false;
    }
    for (std::uint8_t& byte : sectors.at(sector)) {
      byte = cut ? static_cast<std::uint8_t>(byte | noise()) : std::uint8_t{0xFF};
    }
    return cut ? throw PowerCut() : true;
  }

  bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) override {
    EXPECT_EQ(offset % 4, 0U);
    EXPECT_EQ(bytes.size() % 4, 0U);
    for (std::size_t word = 0; word < bytes.size(); word += 4) {
      const bool cut = operations == cut_at;
      if (operations++ == refused_at) {
        return false;
      }
      for (std::size_t i = word; i < word + 4; ++i) {
        std::uint8_t& byte = sectors.at(sector).at(offset + i);
        EXPECT_EQ(byte, 0xFF) << "programmed twice";
        byte = static_cast<std::uint8_t>(byte & (bytes[i] | (cut ? noise() : 0U)));
      }
      if (cut) {
        throw PowerCut();
      }
    }
    return true;
  }

  [[nodiscard]] std::span<const std::uint8_t> contents(unsigned sector) const override { return sectors.at(sector); }
};

}  // namespace proleg::test
