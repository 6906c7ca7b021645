#pragma once

#include <cstdint>
#include <string_view>

#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// The text of an NMT state: "operational", "pre-operational", "stopped", "booting"; for another byte "unknown state".
[[nodiscard]] std::string_view state_text(canopen::NmtState state);

/// The state of a drive by its statusword (0x6041; CiA 402, table 30): "operation enabled", "fault", ...
[[nodiscard]] std::string_view drive_text(std::uint16_t statusword);

/// One sentence that says what a person can do about an error of a module; empty for a code that is not an error.
[[nodiscard]] std::string_view fault_advice(canopen::EmergencyCode code);

}  // namespace proleg::host
