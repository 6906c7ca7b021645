#pragma once

#include <string>

#include "shared/computer/durations/durations.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {

/// Text "0.31 ms (median), 99 % within 0.5 ms; 312 ", followed by the name of the counted things. factor: from the unit
/// of the durations to `unit`. "none" without durations.
[[nodiscard]] std::string durations_text(const Durations& durations, double factor, const std::string& unit,
                                         const std::string& counted);

/// Object for --json: count, median, p99; the last two are null without durations.
[[nodiscard]] Json durations_object(const Durations& durations, double factor);

}  // namespace proleg::tools
