#pragma once

// The settings of the board in the module: what saves them, and what they act on.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Writing the flash stops the program for up to half a second: not while the servo has power, or soon may have.
[[nodiscard]] bool may_write_flash(const Parts& parts);

/// Object 0x1010: what is in force is kept. The node id stays as LSS has stored it.
[[nodiscard]] canopen::AbortCode save_parameters(Parts& parts, std::uint32_t signature);
/// Object 0x1011: all but the node id has its default value from the next reset on.
[[nodiscard]] canopen::AbortCode restore_parameters(Parts& parts, std::uint32_t signature);

/// A frame on 0x7E5. The answer, if there is one.
[[nodiscard]] std::optional<CanFrame> serve_lss(Parts& parts, const CanFrame& request);

}  // namespace proleg::firmware
