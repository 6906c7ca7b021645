#pragma once

#include <string>

#include "shared/computer/durations/durations.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {

/// "0.31 ms (median), 99 % within 0.5 ms; 312 ", with what was counted behind it. factor: from the unit of the
/// durations to `unit`. "none" without durations.
[[nodiscard]] std::string durations_text(const Durations& durations, double factor, const std::string& unit,
                                         const std::string& counted);

/// For --json: count, median, p99; the last two are null without durations.
[[nodiscard]] Json durations_object(const Durations& durations, double factor);

}  // namespace proleg::tools
