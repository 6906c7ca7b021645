#pragma once

#include <termios.h>

#include <optional>
#include <string>

namespace proleg::host {

/// The code of a baud rate in termios; nothing if Linux has none.
[[nodiscard]] std::optional<speed_t> serial_speed(unsigned baud);

/// All baud rates that have a code, for messages.
[[nodiscard]] std::string serial_speeds_text();

}  // namespace proleg::host
