#pragma once

// Flashes a chip like those of a robot: its bootloader receives the image of a module over the bus and installs it, the
// program starts on trial, and confirms itself (docs/flashing.md).

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/mcu/module/virtual_module.hpp"

namespace proleg::sim {

struct FlashedChip {
  /// The bootloader in its place, and slot A with its status words. It has no settings, so it is the same for each
  /// chip.
  FlashContents flash;
  std::size_t image_size = 0;  ///< bytes, with the header
  BusTime flash_time = 0;      ///< from power on of a chip without a program until the program has confirmed itself
  /// Time from power on to the start of the program, which sends its boot-up firmware::boot_up_delay_us() later.
  /// Nothing if the program has not confirmed itself; then it is in slot A, and its trial is still to come.
  std::optional<BusTime> start_time;
  /// Problems that the chip has reported meanwhile (JointModule::take_problem()).
  std::vector<std::string> problems;
};

/// Flashes a chip with this unique id, on a bus of its own. bootloader: its ELF file. Throws ElfError for a file that
/// is not the bootloader and for an image that the bootloader refuses, and std::runtime_error if slot A does not hold
/// the image afterwards: one line each that names the file, what was found and what was expected.
[[nodiscard]] FlashedChip flash_chip(const FirmwareImage& image, const std::filesystem::path& bootloader,
                                     const std::array<std::uint32_t, 3>& unique_id);

}  // namespace proleg::sim
