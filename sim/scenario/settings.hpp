#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/gait/declaration.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The unit as it is printed behind a number: "deg", "Hz", "1/s"; nothing for ratios and counts.
[[nodiscard]] std::string shown_unit(Unit unit);

/// What parse_decimal expects for a value without a range of its own, for messages.
[[nodiscard]] std::string unit_range_text(Unit unit);

/// The value that a text gives a parameter, in its unit. Throws InputError for that file and line if the text is no
/// number in the declared range.
[[nodiscard]] std::int32_t parse_parameter(const Parameter& parameter, const std::string& text, const std::string& file,
                                           int line);

/// Adds a setting to a list in the order of slot, joint, parameter; replaces an earlier setting of the same value.
void put_setting(std::vector<Setting>& settings, const Setting& setting);

/// Gives a parameter its start value. Scenario::settings has no value that is the default, none twice, and is in the
/// order of slot, joint, parameter.
void set_start_value(Scenario& scenario, const Setting& setting);

/// The value of a parameter at the start of a run.
[[nodiscard]] std::int32_t start_value(const Scenario& scenario, unsigned slot, unsigned joint, unsigned parameter);

}  // namespace proleg::sim
