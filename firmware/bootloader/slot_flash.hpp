#pragma once

// The flash that a bootloader writes: the two slots, and the records of what the module trusts. The chip and the native
// module implement it.

#include <cstdint>
#include <span>

namespace proleg::bootloader {

/// A part of the flash.
enum class FlashSlot : std::uint8_t {
  a,      ///< the program runs from here
  b,      ///< backup
  trust,  ///< records (trust_store.hpp)
};

/// The flash of the slots. An operation takes long, and the program stands still meanwhile.
class SlotFlash {
 public:
  /// Sets all bytes of slot A or B to 0xFF. Returns whether it succeeded. The records cannot be erased.
  [[nodiscard]] virtual bool erase(FlashSlot slot) = 0;
  /// Programs bytes that are 0xFF, word by word in ascending order. offset and size: multiples of 4. Returns whether it
  /// succeeded.
  [[nodiscard]] virtual bool program(FlashSlot slot, std::uint32_t offset, std::span<const std::uint8_t> bytes) = 0;
  /// The bytes of a slot. A and B have the same size: a multiple of 4, more than an image and 16 bytes. The records
  /// have room for one at least.
  [[nodiscard]] virtual std::span<const std::uint8_t> contents(FlashSlot slot) const = 0;
  /// Whether the supply is good enough for erase() and program().
  [[nodiscard]] virtual bool is_supplied() const { return true; }

 protected:
  ~SlotFlash() = default;
};

}  // namespace proleg::bootloader
