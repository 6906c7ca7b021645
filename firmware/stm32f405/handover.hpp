#pragma once

// The words that starts of the chip leave for each other (firmware/bootloader/handover.hpp), at a fixed place of the
// RAM. The module's program and the bootloader have different RAM, except for these words.

#include "firmware/bootloader/handover.hpp"

namespace proleg::stm32f405 {

/// What the last start has left; `none` if it was taken before. After power-on the RAM is arbitrary, which reads as
/// `none`.
[[nodiscard]] bootloader::Handover read_handover();
/// What the last start has left. Afterwards it is `none`.
[[nodiscard]] bootloader::Handover take_handover();
void leave_handover(const bootloader::Handover& handover);

}  // namespace proleg::stm32f405
