#pragma once

// The two slots of the flash. The program of the module runs from slot A; slot B holds a copy of the last image that
// has proven itself. A or B always holds a complete image, whenever the power fails:
//
//   install   copies A to B if A is proven and B is not the same, then erases A and writes the new image
//   start     A is complete and confirmed: it runs
//             A is complete but not confirmed: it runs on trial, at most `max_attempts` times; after that B is restored
//             A is not complete: B is restored
//             A and B are not complete: there is nothing to run
//   restore   erases A and copies B to A
//
// An image is confirmed when it has started well (the module's own check, or its host). The header of an image is
// written last, so a header that is right stands before a body that was written completely.
//
// Contents of a slot:
//   0                           image (shared/image/image_header.hpp)
//   size - 16                   u32  the word `confirmed_word`, or erased
//   size - 12, - 8, - 4         u32  erased; 0 for each start on trial
// The words are programmed once each; one erase clears image and words.

#include <array>
#include <cstdint>
#include <span>

#include "shared/image/image_header.hpp"

namespace proleg::bootloader {

enum class FlashSlot : std::uint8_t { a, b };

/// The flash of the two slots. An operation takes long, and the program stands still meanwhile.
class SlotFlash {
 public:
  /// Sets all bytes of a slot to 0xFF. Returns whether it succeeded.
  [[nodiscard]] virtual bool erase(FlashSlot slot) = 0;
  /// Programs bytes that are 0xFF, word by word in ascending order. offset and size: multiples of 4. Returns whether it
  /// succeeded.
  [[nodiscard]] virtual bool program(FlashSlot slot, std::uint32_t offset, std::span<const std::uint8_t> bytes) = 0;
  /// The bytes of a slot. Both slots have the same size: a multiple of 4, more than an image and 16 bytes.
  [[nodiscard]] virtual std::span<const std::uint8_t> contents(FlashSlot slot) const = 0;
  /// Whether the supply is good enough for erase() and program().
  [[nodiscard]] virtual bool is_supplied() const { return true; }

 protected:
  ~SlotFlash() = default;
};

enum class StartResult : std::uint8_t {
  run,           ///< the image in A runs, which is confirmed
  run_on_trial,  ///< the image in A runs; a start on trial has been counted
  nothing,       ///< no slot has an image that may run
  flash_failed,  ///< the flash does not work as it should; an image in a slot may run at another try
};

enum class InstallResult : std::uint8_t {
  ok,
  already_there,  ///< A holds this image, and has not failed to start; nothing was written
  backup_failed,  ///< the flash of B failed; A is unchanged
  flash_failed,   ///< the flash of A failed; B will be restored at the next start
};

class Slots {
 public:
  static constexpr unsigned max_attempts = 3;
  static constexpr std::uint32_t confirmed_word = 0x600D'600D;
  static constexpr std::uint32_t words_size = 4 * (1 + max_attempts);  ///< size of the words at the end of a slot

  /// place: board and place of images, with the room that a slot has.
  Slots(SlotFlash& flash, const image::Place& place) : flash_(flash), place_(place) {}

  /// Decides which image runs, and restores A if that is needed.
  [[nodiscard]] StartResult prepare_start();
  /// Whether prepare_start() would find something that may run.
  [[nodiscard]] bool may_start() const;
  /// Writes an image into A. The caller has checked it (image::check_image()).
  [[nodiscard]] InstallResult install(std::span<const std::uint8_t> image);
  /// Confirms the image in A, which has started well. Returns whether the flash holds that now. Does nothing if it is
  /// confirmed already.
  [[nodiscard]] bool confirm();

  /// The complete image in a slot; empty if there is none.
  [[nodiscard]] std::span<const std::uint8_t> image_in(FlashSlot slot) const;
  [[nodiscard]] bool is_confirmed(FlashSlot slot) const;
  /// Number of starts on trial of the image in A.
  [[nodiscard]] unsigned attempts() const;

 private:
  [[nodiscard]] bool write(FlashSlot slot, std::span<const std::uint8_t> image, bool is_proven);
  [[nodiscard]] bool clear(FlashSlot slot);
  [[nodiscard]] std::uint32_t word_at(FlashSlot slot, std::uint32_t offset) const;
  [[nodiscard]] std::uint32_t words_at() const;

  SlotFlash& flash_;
  image::Place place_;
};

}  // namespace proleg::bootloader
