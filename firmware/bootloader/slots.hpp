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
// A module that has a key (trust_store.hpp) takes only images that are signed with it: they are checked before anything
// is erased, and at each start on trial. The backup was checked when it was installed. What a confirmed image says
// about later ones, a new key or a higher lowest version, is kept at the first start after it was confirmed.
//
// An image is confirmed when it has started well (the module's own check, or its host). The header of an image is
// written last, so a header that is right stands before a body that was written completely.
//
// Contents of a slot:
//   0                           image (shared/image/image_header.hpp)
//   size - 16                   u32  the word `confirmed_word`, or erased
//   size - 12, - 8, - 4         u32  erased; 0 for each start on trial
// The words are programmed once each; one erase clears image and words.

#include <cstdint>
#include <span>

#include "firmware/bootloader/trust_store.hpp"

namespace proleg::bootloader {

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
  Slots(SlotFlash& flash, const image::Place& place) : flash_(flash), place_(place), trust_(flash) {}

  /// Decides which image runs, and restores A if that is needed. If A is confirmed it keeps what its image says about
  /// later images.
  [[nodiscard]] StartResult prepare_start();
  /// Whether the image in A, which is confirmed, says something about later images that is not kept yet.
  [[nodiscard]] bool has_new_trust() const;
  /// Keeps it. If the power or the flash fails, the next call does it. Does nothing if there is nothing new.
  void keep_new_trust();
  /// Checks an image: whether it is right, fits the board, and is trusted.
  [[nodiscard]] image::Error check(std::span<const std::uint8_t> image) const;
  /// Whether prepare_start() would find something that may run.
  [[nodiscard]] bool may_start() const;
  /// Writes an image into A. The caller has checked it with check().
  [[nodiscard]] InstallResult install(std::span<const std::uint8_t> image);
  /// Confirms the image in A, which has started well. Returns whether the flash holds that now. Does nothing if it is
  /// confirmed already.
  [[nodiscard]] bool confirm();

  /// The complete image in a slot; empty if there is none.
  [[nodiscard]] std::span<const std::uint8_t> image_in(FlashSlot slot) const;
  [[nodiscard]] bool is_confirmed(FlashSlot slot) const;
  /// Number of starts on trial of the image in A.
  [[nodiscard]] unsigned attempts() const;

  [[nodiscard]] TrustStore& trust() { return trust_; }
  [[nodiscard]] const TrustStore& trust() const { return trust_; }

 private:
  [[nodiscard]] bool may_try(std::span<const std::uint8_t> image) const;
  [[nodiscard]] bool write(FlashSlot slot, std::span<const std::uint8_t> image, bool is_proven);
  [[nodiscard]] bool clear(FlashSlot slot);
  [[nodiscard]] std::uint32_t word_at(FlashSlot slot, std::uint32_t offset) const;
  [[nodiscard]] std::uint32_t words_at() const;

  SlotFlash& flash_;
  image::Place place_;
  TrustStore trust_;
};

}  // namespace proleg::bootloader
