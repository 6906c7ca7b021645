#include "firmware/bootloader/slots.hpp"

#include <algorithm>

#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::bootloader {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t erased_word = 0xFFFF'FFFF;

std::array<std::uint8_t, 4> bytes_of(std::uint32_t word) {
  std::array<std::uint8_t, 4> bytes{};
  write_little_endian(bytes, 0, bytes.size(), word);
  return bytes;
}

/// Whether two images are the same. Their headers have the hash of what follows.
bool is_same(Bytes one, Bytes other) {
  return one.size() == other.size() &&
         (one.empty() || std::ranges::equal(one.first(image::header_size), other.first(image::header_size)));
}

}  // namespace

StartResult Slots::prepare_start() {
  for (bool is_restored = false;; is_restored = true) {
    const Bytes current = image_in(FlashSlot::a);
    if (!current.empty() && is_confirmed(FlashSlot::a)) {
      keep_new_trust();
      return StartResult::run;
    }
    if (may_try(current)) {
      return flash_.program(FlashSlot::a, words_at() + 4 * (1 + attempts()), bytes_of(0)) ? StartResult::run_on_trial
                                                                                          : StartResult::flash_failed;
    }
    const Bytes backup = image_in(FlashSlot::b);
    if (backup.empty() || is_same(backup, current)) {
      return StartResult::nothing;  // the copy of an image that has failed would fail, too
    }
    if (is_restored || !write(FlashSlot::a, backup, is_confirmed(FlashSlot::b))) {
      return StartResult::flash_failed;
    }
  }
}

bool Slots::may_start() const {
  const Bytes current = image_in(FlashSlot::a);
  if ((!current.empty() && is_confirmed(FlashSlot::a)) || may_try(current)) {
    return true;
  }
  const Bytes backup = image_in(FlashSlot::b);
  return !backup.empty() && !is_same(backup, current);
}

/// Whether an image in A that is not confirmed may be started.
bool Slots::may_try(Bytes image) const {
  return !image.empty() && attempts() < max_attempts && check(image) == image::Error::none;
}

bool Slots::has_new_trust() const {
  // Each start asks this, so most images must take no time: the records are read, and the checksum of the image is
  // computed, only if its header says something.
  const Bytes header = flash_.contents(FlashSlot::a).first(image::header_size);
  if (!is_confirmed(FlashSlot::a) || !image::changes_trust(header)) {
    return false;
  }
  const image::Trust present = trust_.read();
  return image::trust_after(present, header) != present && !image_in(FlashSlot::a).empty() && !trust_.is_full();
}

void Slots::keep_new_trust() {
  if (!has_new_trust()) {
    return;
  }
  const Bytes current = image_in(FlashSlot::a);
  // An image that was installed before the key was set, or signed with the key before this one, changes nothing.
  if (check(current) == image::Error::none) {
    static_cast<void>(trust_.append(image::trust_after(trust_.read(), current)));
  }
}

image::Error Slots::check(Bytes image) const {
  const image::Trust present = trust_.read();
  image::Error error = image::check_image(image, place_);
  if (error == image::Error::none) {
    error = image::check_trust(present, image);
  }
  const bool needs_room = error == image::Error::none && image::trust_after(present, image) != present;
  return needs_room && trust_.is_full() ? image::Error::no_room_for_key : error;
}

InstallResult Slots::install(Bytes image) {
  const Bytes current = image_in(FlashSlot::a);
  if (is_same(current, image) && (is_confirmed(FlashSlot::a) || attempts() == 0)) {
    return InstallResult::already_there;  // else the trial of the image begins again
  }
  const Bytes backup = image_in(FlashSlot::b);
  const bool is_current_better = is_confirmed(FlashSlot::a) || backup.empty();
  const bool is_copied = is_same(backup, current) && is_confirmed(FlashSlot::b) == is_confirmed(FlashSlot::a);
  if (!current.empty() && is_current_better && !is_copied &&
      !write(FlashSlot::b, current, is_confirmed(FlashSlot::a))) {
    return InstallResult::backup_failed;
  }
  return write(FlashSlot::a, image, false) ? InstallResult::ok : InstallResult::flash_failed;
}

bool Slots::confirm() {
  return is_confirmed(FlashSlot::a) ||
         (flash_.program(FlashSlot::a, words_at(), bytes_of(confirmed_word)) && is_confirmed(FlashSlot::a));
}

Bytes Slots::image_in(FlashSlot slot) const {
  const Bytes contents = flash_.contents(slot);
  image::Summary header;
  if (image::decode(contents, header) != image::Error::none ||
      image::check_place(header, place_) != image::Error::none ||
      crc32(contents.subspan(image::header_size, header.length)) != header.crc) {
    return {};
  }
  return contents.first(image::header_size + header.length);
}

bool Slots::is_confirmed(FlashSlot slot) const { return word_at(slot, words_at()) == confirmed_word; }

unsigned Slots::attempts() const {
  unsigned used = 0;
  while (used < max_attempts && word_at(FlashSlot::a, words_at() + 4 * (1 + used)) != erased_word) {
    ++used;
  }
  return used;
}

/// Makes a slot empty. An erase that is cut off can leave bits that read as before for a while, so the slot gets an
/// invalid header first.
bool Slots::clear(FlashSlot slot) {
  return (image_in(slot).empty() || flash_.program(slot, 0, bytes_of(0))) && flash_.erase(slot);
}

/// Writes an image. The header is written last: before it is complete, the slot holds no image.
bool Slots::write(FlashSlot slot, Bytes image, bool is_proven) {
  return clear(slot) && flash_.program(slot, image::header_size, image.subspan(image::header_size)) &&
         (!is_proven || flash_.program(slot, words_at(), bytes_of(confirmed_word))) &&
         flash_.program(slot, 0, image.first(image::header_size)) &&
         std::ranges::equal(image, flash_.contents(slot).first(image.size())) && is_confirmed(slot) == is_proven;
}

std::uint32_t Slots::word_at(FlashSlot slot, std::uint32_t offset) const {
  return read_little_endian(flash_.contents(slot), offset, 4);
}

std::uint32_t Slots::words_at() const {
  return static_cast<std::uint32_t>(flash_.contents(FlashSlot::a).size()) - words_size;
}

}  // namespace proleg::bootloader
