#pragma once

#include <vector>

#include "sim/optimize/confirm/gait_confirmation.hpp"

namespace proleg::optimize {

/// What the runs of a gait say about it. confirmation: its findings are not read.
[[nodiscard]] std::vector<ConfirmationFinding> find_doubts(const GaitConfirmation& confirmation);

}  // namespace proleg::optimize
