#pragma once

#include <vector>

#include "host/server/signal_layout.hpp"
#include "tools/proleg/ui/telemetry_row.hpp"

namespace proleg::tools {

/// Where the values of the signals are in a row; it makes the document `telemetry`.
[[nodiscard]] host::SignalLayout layout_of(const std::vector<Signal>& signals);

}  // namespace proleg::tools
