#pragma once

// A serial device, as the file system shows it: it is not opened, because some adapters reset when they are.

#include <string>
#include <vector>

namespace proleg::host {

struct SerialDevice {
  bool exists = false;
  bool is_character_device = false;
  bool may_use = false;               ///< this process may read and write it
  std::string group;                  ///< that owns it
  bool is_user_in_group = false;      ///< this process is
  std::vector<std::string> programs;  ///< that have it open, such as "ModemManager (process 812)"; others' are known to
                                      ///< root only
};

[[nodiscard]] SerialDevice read_serial_device(const std::string& path);

}  // namespace proleg::host
