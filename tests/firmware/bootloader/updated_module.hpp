#pragma once

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "slot_memory.hpp"

namespace proleg::bootloader::test {

inline constexpr image::Place place{1, 0, 0x0802'0200, 1024};
inline constexpr std::size_t slot_size = image::header_size + 1024 + Slots::words_size;

struct Image {
  image::Header header;
  std::vector<std::uint8_t> body;

  [[nodiscard]] std::vector<std::uint8_t> bytes() const {
    const image::HeaderBytes header_bytes = image::encode(header);
    std::vector<std::uint8_t> all(header_bytes.begin(), header_bytes.end());
    all.insert(all.end(), body.begin(), body.end());
    return all;
  }
};

inline Image make_image(std::uint16_t number, std::size_t size = 64) {
  Image made;
  std::mt19937 random(number);
  made.body.resize(size);
  for (std::uint8_t& byte : made.body) {
    byte = static_cast<std::uint8_t>(random());
  }
  made.header.board_id = place.board_id;
  made.header.version = {number, 0, 0};
  made.header.address = place.address;
  image::describe_body(made.header, made.body);
  return made;
}

/// Number of the image in a slot; 0: none.
inline unsigned number_in(const Slots& slots, FlashSlot slot) {
  const auto image = slots.image_in(slot);
  return image.empty() ? 0 : image::decode(image).header.version.major;
}

/// Flash and slots of a module that is updated.
class UpdatedModule {
 public:
  UpdatedModule() = default;
  explicit UpdatedModule(const SlotMemory& state) : flash(state) {}
  UpdatedModule(const UpdatedModule&) = delete;
  UpdatedModule& operator=(const UpdatedModule&) = delete;

  InstallResult install(const Image& image) { return slots.install(image.bytes()); }

  /// Switches the power on, without a cut. Returns the number of the image that runs; 0: none.
  unsigned start() {
    flash.cut_at = -1;
    const StartResult result = slots.prepare_start();
    return result == StartResult::run || result == StartResult::run_on_trial ? number_in(slots, FlashSlot::a) : 0;
  }

  /// Installs an image that starts well.
  void install_proven(const Image& image) {
    EXPECT_EQ(install(image), InstallResult::ok);
    EXPECT_EQ(start(), image.header.version.major);
    EXPECT_TRUE(slots.confirm());
  }

  SlotMemory flash{slot_size};
  Slots slots{flash, place};
};

inline const Image first = make_image(1);
inline const Image second = make_image(2, 200);
inline const Image third = make_image(3, 1024);

}  // namespace proleg::bootloader::test
