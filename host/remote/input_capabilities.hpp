#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace proleg::host {

/// Capabilities of an input device that the kernel reports in /sys/class/input/eventN/device. Every user may read this
/// folder, so keyboards and mice are never opened.
struct InputCapabilities {
  std::string name;
  std::string keys;       ///< text of the file capabilities/key
  std::string relatives;  ///< text of the file capabilities/rel
};

/// Reads the capabilities; the text of a file that is absent is empty.
[[nodiscard]] InputCapabilities read_capabilities(const std::filesystem::path& device_folder);

/// Whether a bit is set in a bitmap as the kernel writes it: hexadecimal numbers of the size of a long, the highest
/// first. False for any other text.
[[nodiscard]] bool has_bit(std::string_view bitmap, unsigned bit);

/// Whether the device is a gamepad, a joystick, or a part of a Wiimote.
[[nodiscard]] bool is_remote_control(const InputCapabilities& capabilities);

}  // namespace proleg::host
