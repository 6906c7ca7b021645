#pragma once

#include <optional>
#include <vector>

#include "host/robot/findings.hpp"

namespace proleg::host {

/// Finds drives that have switched their servo off (Fault), by cause.
[[nodiscard]] std::vector<Finding> find_drive_faults(const BusObservations& observations);
/// Finds drives that hold their safe pose (quick stop).
[[nodiscard]] std::optional<Finding> find_quick_stop(const BusObservations& observations);

}  // namespace proleg::host
