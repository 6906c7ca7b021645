#pragma once

#include <termios.h>

#include <optional>
#include <string>

namespace proleg::host {

/// The code that termios has for a baud rate; nothing if Linux has none.
[[nodiscard]] std::optional<speed_t> serial_speed(unsigned baud);

/// All baud rates for which there is a code, for messages.
[[nodiscard]] std::string serial_speeds_text();

}  // namespace proleg::host
