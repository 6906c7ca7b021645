#pragma once

// What a module trusts (shared/image/image_trust.hpp), in flash: records one after the other, of which the last valid
// one counts. Nothing is ever erased, so a cut of the power leaves the record before or the new one. A record that was
// cut off, or whose flash is bad, is skipped. When the flash is full, nothing changes any more.
//
// Record, 64 bytes (little-endian; what is not listed is 0):
//   0  u32       the characters PKEY
//   4  32 bytes  the key with which images must be signed
//  36  u16       lowest version: major, u16 minor, u16 patch
//  60  u32       CRC-32 (shared/fixed/crc32.hpp) of the 60 bytes before

#include "firmware/bootloader/slot_flash.hpp"
#include "shared/broadcast/transfer_frame.hpp"
#include "shared/image/image_trust.hpp"

namespace proleg::bootloader {

class TrustStore {
 public:
  static constexpr std::size_t record_size = 64;
  using Record = std::array<std::uint8_t, record_size>;

  explicit TrustStore(SlotFlash& flash) : flash_(flash) {}

  /// What the records say; without a valid one the module takes any image.
  [[nodiscard]] image::Trust read() const { return newest(flash_.contents(FlashSlot::trust)); }
  [[nodiscard]] bool is_full() const { return used() == flash_.contents(FlashSlot::trust).size() / record_size; }
  /// Adds a record. trust: with a key. Returns whether the flash holds it now. If the flash was bad, a part of the room
  /// is lost, and the old trust stays.
  [[nodiscard]] bool append(const image::Trust& trust);

  /// What some records say.
  [[nodiscard]] static image::Trust newest(std::span<const std::uint8_t> records);
  /// What records say, as the module reports it.
  [[nodiscard]] static broadcast::TrustSummary summary(std::span<const std::uint8_t> records);
  [[nodiscard]] broadcast::TrustSummary summary() const { return summary(flash_.contents(FlashSlot::trust)); }
  /// The bytes of a record.
  [[nodiscard]] static Record encode(const image::Trust& trust);

 private:
  [[nodiscard]] std::size_t used() const;

  SlotFlash& flash_;
};

}  // namespace proleg::bootloader
