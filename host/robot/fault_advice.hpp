#pragma once

#include <string_view>

#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// One sentence that says what a person can do about an error of a module; empty for a code that is not an error.
[[nodiscard]] std::string_view fault_advice(canopen::EmergencyCode code);

}  // namespace proleg::host
