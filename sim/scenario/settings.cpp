#include "sim/scenario/settings.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"

namespace proleg::sim {
namespace {

auto key_of(const Setting& setting) {
  return std::tuple(setting.slot, setting.joint, setting.internal, setting.number);
}

/// Whether a parameter takes every value of its unit, which wraps.
bool takes_any_angle(const Parameter& parameter) {
  using Limits = std::numeric_limits<std::int32_t>;
  return wraps(parameter.unit) && parameter.minimum == Limits::min() && parameter.maximum == Limits::max();
}

std::string range_text(const Parameter& parameter) {
  if (takes_any_angle(parameter)) {
    return unit_range_text(parameter.unit);
  }
  const std::string symbol = shown_unit(parameter.unit);
  return "a number from " + std::string(format_decimal(parameter.minimum, parameter.unit).view()) + " to " +
         std::string(format_decimal(parameter.maximum, parameter.unit).view()) + (symbol.empty() ? "" : " " + symbol);
}

}  // namespace

std::string shown_unit(Unit unit) { return unit == Unit::ratio ? "" : scale_of(unit).symbol; }

std::string unit_range_text(Unit unit) {
  if (wraps(unit)) {
    return "a number above -23592960 and below 23592960 deg";  // 2^16 turns
  }
  const std::string symbol = shown_unit(unit);
  return "a number in the range of the unit" + (symbol.empty() ? "" : " " + symbol);
}

std::int32_t parse_parameter(const Parameter& parameter, const std::string& text, const std::string& file, int line) {
  const DecimalResult result = parse_decimal(text, parameter.unit);
  if (result.error != DecimalError::none || result.raw < parameter.minimum || result.raw > parameter.maximum) {
    throw InputError(file, line, in_quotes(text) + " for parameter " + in_quotes(parameter.name),
                     range_text(parameter));
  }
  return result.raw;
}

void put_setting(std::vector<Setting>& settings, const Setting& setting) {
  const auto position = std::ranges::lower_bound(settings, key_of(setting), {}, key_of);
  if (position != settings.end() && key_of(*position) == key_of(setting)) {
    *position = setting;
  } else {
    settings.insert(position, setting);
  }
}

void set_start_value(Scenario& scenario, const Setting& setting) {
  const Declaration& declaration = scenario.kernel.slots[setting.slot].algorithm->declaration();
  if (setting.value == declaration.parameters[setting.number].default_value) {
    std::erase_if(scenario.settings, [&](const Setting& other) { return key_of(other) == key_of(setting); });
  } else {
    put_setting(scenario.settings, setting);
  }
}

std::int32_t start_value(const Scenario& scenario, unsigned slot, unsigned joint, unsigned parameter) {
  const auto key = key_of({static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(joint),
                           static_cast<std::uint8_t>(parameter), false, 0});
  const auto position = std::ranges::lower_bound(scenario.settings, key, {}, key_of);
  return position != scenario.settings.end() && key_of(*position) == key
             ? position->value
             : scenario.kernel.slots[slot].algorithm->declaration().parameters[parameter].default_value;
}

}  // namespace proleg::sim
