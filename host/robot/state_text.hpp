#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// The text of an NMT state: "operational", "pre-operational", "stopped", "booting"; for another byte "unknown state".
[[nodiscard]] std::string_view state_text(canopen::NmtState state);

/// The state of a drive by its statusword (0x6041; CiA 402, table 30): "operation enabled", "fault", ...
[[nodiscard]] std::string_view drive_text(std::uint16_t statusword);

/// Which images a module takes, by the id of its key (0x2000:6): "key 1a2b3c4d", or "takes any image".
[[nodiscard]] std::string image_key_text(std::uint32_t key_id);

/// One sentence that says what a person can do about an error of a module; empty for a code that is not an error.
[[nodiscard]] std::string_view fault_advice(canopen::EmergencyCode code);

}  // namespace proleg::host
