#pragma once

#include "shared/canopen/object.hpp"
#include "shared/kernel/status.hpp"

namespace proleg::firmware {

/// SDO abort code that stands for a status of the kernel.
[[nodiscard]] canopen::AbortCode abort_code_of(Status status);

}  // namespace proleg::firmware
