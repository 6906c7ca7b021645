#pragma once

#include <string_view>

#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// What a person can do about an error that a module reports: one sentence; empty for what is no error.
[[nodiscard]] std::string_view fault_advice(canopen::EmergencyCode code);

}  // namespace proleg::host
