#pragma once

// Describes a serial device by the file system. The device is not opened, because some adapters reset when they are.

#include <termios.h>

#include <optional>
#include <string>
#include <vector>

namespace proleg::host {

/// The code of a baud rate in termios; nothing if Linux has none.
[[nodiscard]] std::optional<speed_t> serial_speed(unsigned baud);

/// All baud rates that have a code, for messages.
[[nodiscard]] std::string serial_speeds_text();

struct SerialDevice {
  bool exists = false;
  bool is_character_device = false;
  bool may_use = false;               ///< this process may read and write the device
  std::string group;                  ///< group that owns the device
  bool is_user_in_group = false;      ///< this process is in the group
  std::vector<std::string> programs;  ///< that have it open, such as "ModemManager (process 812)"; others' are known to
                                      ///< root only
};

[[nodiscard]] SerialDevice read_serial_device(const std::string& path);

}  // namespace proleg::host
