#pragma once

// Saving and restoring the settings of the board.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Whether flash may be written now. That stops the program for up to half a second, so the servo must not have power,
/// and must not get it soon.
[[nodiscard]] bool may_write_flash(const Parts& parts);

/// Object 0x1010: saves the settings in force. The node id stays as LSS has stored it.
[[nodiscard]] canopen::AbortCode save_parameters(Parts& parts, std::uint32_t signature);
/// Object 0x1011: from the next reset on, all settings but the node id have their default values.
[[nodiscard]] canopen::AbortCode restore_parameters(Parts& parts, std::uint32_t signature);

/// Handles a frame on 0x7E5. Returns the answer, if there is one.
[[nodiscard]] std::optional<CanFrame> serve_lss(Parts& parts, const CanFrame& request);

}  // namespace proleg::firmware
