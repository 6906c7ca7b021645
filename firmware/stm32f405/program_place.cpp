#include "firmware/stm32f405/program_place.hpp"

#include <array>
#include <cstring>

#include "firmware/stm32f405/flash.hpp"
#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/handover.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "shared/fixed/little_endian.hpp"

extern "C" {

/// RAM that the program does not use; the linker script defines it.
extern std::uint8_t image_buffer_start[];
extern std::uint8_t image_buffer_end[];

}  // extern "C"

namespace proleg::stm32f405 {
namespace {

using bootloader::HandoverAction;
using bootloader::Slots;

constexpr std::uint32_t confirmed_word_address =
    flash_layout::image_sector_a.address + flash_layout::image_sector_a.size - Slots::words_size;

/// Whether the bootloader has started the program. `started` stays until the program has started well: it may stop
/// before.
bool was_started_by_bootloader() {
  const HandoverAction action = read_handover().action;
  return action == HandoverAction::started || action == HandoverAction::runs;
}

/// Restarts the chip. A reset would shorten the servo's last pulse, so it waits for its end.
[[noreturn]] void restart_with(const bootloader::Handover& handover, const Servo& servo) {
  servo.finish_last_pulse();
  leave_handover(handover);
  reset_chip();
}

}  // namespace

std::span<std::uint8_t> ProgramPlace::buffer() { return {image_buffer_start, image_buffer_end}; }

std::span<const std::uint8_t> ProgramPlace::header() const {
  return {reinterpret_cast<const std::uint8_t*>(std::uintptr_t{flash_layout::slot_a}), image::header_size};
}

bool ProgramPlace::has_bootloader() const { return was_started_by_bootloader(); }

bool ProgramPlace::is_confirmed() const {
  std::uint32_t word = 0;
  std::memcpy(&word, reinterpret_cast<const void*>(std::uintptr_t{confirmed_word_address}), sizeof(word));
  return word == Slots::confirmed_word;
}

void ProgramPlace::confirm() {
  std::array<std::uint8_t, 4> bytes{};
  write_little_endian(bytes, 0, bytes.size(), Slots::confirmed_word);
  static_cast<void>(program_words(confirmed_word_address, bytes));  // if it fails the trial continues
}

void ProgramPlace::note_good_start() {
  if (was_started_by_bootloader()) {
    leave_handover({HandoverAction::runs, 0});
  }
}

broadcast::TrustSummary ProgramPlace::trust_summary() const {
  constexpr flash_layout::Sector sector = flash_layout::trust_sector;
  return bootloader::TrustStore::summary(
      {reinterpret_cast<const std::uint8_t*>(std::uintptr_t{sector.address}), sector.size});
}

void ProgramPlace::install(const firmware::Installation& what) {
  const bootloader::ImageInRam image{static_cast<std::uint32_t>(what.size), what.session, what.ends_line,
                                     what.run_time < bootloader::first_key_time_us};
  restart_with({HandoverAction::install, image.argument()}, servo_);
}

void ProgramPlace::enter_bootloader() { restart_with({HandoverAction::stay, 0}, servo_); }

}  // namespace proleg::stm32f405
