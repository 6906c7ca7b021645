#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <stdexcept>
#include <vector>

#include "firmware/bootloader/slots.hpp"

namespace proleg::bootloader::test {

struct PowerCut : std::runtime_error {
  PowerCut() : std::runtime_error("power cut") {}
};

/// NOR flash of two slots and the records of what the module trusts: a program operation clears bits of one word; an
/// erase first clears the bits of a slot and then sets them. The power can fail at any operation, which then is done in
/// part.
class SlotMemory final : public SlotFlash {
 public:
  explicit SlotMemory(std::size_t slot_size) { slots.fill(std::vector<std::uint8_t>(slot_size, 0xFF)); }

  std::array<std::vector<std::uint8_t>, 3> slots;  ///< by FlashSlot
  int operations = 0;                              ///< number of words programmed and slots erased
  int cut_at = -1;                                 ///< the operation that does not end
  int refused_at = -1;                             ///< the operation that reports an error
  bool has_supply = true;
  /// Whether an erase that is cut off leaves all bits as they were. (They are weak now, and may read otherwise later.)
  bool erases_leave_all = false;
  std::mt19937 noise{1};

  bool erase(FlashSlot slot) override {
    const bool cut = operations == cut_at;
    if (operations++ == refused_at) {
      return false;
    }
    std::vector<std::uint8_t>& bytes = bytes_of(slot);
    if (!cut) {
      std::ranges::fill(bytes, std::uint8_t{0xFF});
      return true;
    }
    if (erases_leave_all) {
      throw PowerCut();
    }
    const auto stage = static_cast<unsigned>(noise() % 3);
    for (std::uint8_t& byte : bytes) {
      const auto random = static_cast<std::uint8_t>(noise());
      byte = stage == 0 ? byte & random : stage == 1 ? random : byte | random;
    }
    throw PowerCut();
  }

  [[nodiscard]] bool is_supplied() const override { return has_supply; }

  bool program(FlashSlot slot, std::uint32_t offset, std::span<const std::uint8_t> bytes) override {
    EXPECT_EQ(offset % 4, 0U);
    EXPECT_EQ(bytes.size() % 4, 0U);
    std::vector<std::uint8_t>& slot_bytes = bytes_of(slot);
    for (std::size_t word = 0; word < bytes.size(); word += 4) {
      const bool cut = operations == cut_at;
      if (operations++ == refused_at) {
        return false;
      }
      const std::uint32_t undone = cut ? static_cast<std::uint32_t>(noise()) : 0;
      for (std::size_t i = 0; i < 4; ++i) {
        std::uint8_t& byte = slot_bytes.at(offset + word + i);
        const std::uint8_t wanted = bytes[word + i];
        if ((byte & wanted) != wanted) {
          ADD_FAILURE() << "a bit cannot be set without an erase";
        }
        byte = static_cast<std::uint8_t>(byte & (wanted | undone >> (8 * i)));
      }
      if (cut) {
        throw PowerCut();
      }
    }
    return true;
  }

  [[nodiscard]] std::span<const std::uint8_t> contents(FlashSlot slot) const override {
    return slots.at(static_cast<std::size_t>(slot));
  }

 private:
  std::vector<std::uint8_t>& bytes_of(FlashSlot slot) { return slots.at(static_cast<std::size_t>(slot)); }
};

}  // namespace proleg::bootloader::test
