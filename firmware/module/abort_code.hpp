#pragma once

#include "shared/canopen/object.hpp"
#include "shared/kernel/status.hpp"

namespace proleg::firmware {

/// SDO abort code for what the kernel answers.
[[nodiscard]] canopen::AbortCode abort_code_of(Status status);

}  // namespace proleg::firmware
