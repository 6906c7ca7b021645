#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace proleg::host {

/// What the kernel says of an input device in /sys/class/input/eventN/device. Everybody may read it, so keyboards and
/// mice are never opened.
struct InputCapabilities {
  std::string name;
  std::string keys;       ///< capabilities/key
  std::string relatives;  ///< capabilities/rel
};

/// Empty texts for files that are not there.
[[nodiscard]] InputCapabilities read_capabilities(const std::filesystem::path& device_folder);

/// A bitmap as the kernel writes it: words of a long in hexadecimal, the highest first. False for anything else.
[[nodiscard]] bool has_bit(std::string_view bitmap, unsigned bit);

/// A gamepad, a joystick, or a part of a Wiimote.
[[nodiscard]] bool is_remote_control(const InputCapabilities& capabilities);

}  // namespace proleg::host
