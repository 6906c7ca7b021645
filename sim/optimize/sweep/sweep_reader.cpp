#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/sweep/sweep.hpp"
#include "sim/optimize/sweep/sweep_request.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::optimize {
namespace {

/// A decimal number as a whole number of 10^-decimals: steps of 0.1 add up without rounding.
struct Decimal {
  std::int64_t digits = 0;
  int decimals = 0;
};

constexpr std::size_t max_digits = 15;

std::optional<Decimal> parse_decimal_text(std::string_view argument) {
  std::string digits(argument);
  Decimal decimal;
  if (const std::size_t point = digits.find('.'); point != std::string::npos) {
    decimal.decimals = static_cast<int>(digits.size() - point - 1);
    digits.erase(point, 1);
  }
  const bool negative = digits.starts_with('-');
  if (digits.size() - (negative ? 1U : 0U) > max_digits) {
    return std::nullopt;
  }
  const std::optional<std::int64_t> value = parse_whole<std::int64_t>(digits);
  if (!value) {
    return std::nullopt;
  }
  decimal.digits = *value;
  return decimal;
}

std::int64_t power_of_ten(int exponent) {
  std::int64_t result = 1;
  for (int i = 0; i < exponent; ++i) {
    result *= 10;
  }
  return result;
}

/// Text of a decimal number, without trailing zeros behind the point.
std::string decimal_text(std::int64_t digits, int decimals) {
  std::string text = std::to_string(std::abs(digits));
  if (decimals > 0) {
    const auto places = static_cast<std::size_t>(decimals);
    text.insert(0, text.size() > places ? 0 : places + 1 - text.size(), '0');
    text.insert(text.size() - places, ".");
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) {
      text.pop_back();
    }
  }
  return digits < 0 ? "-" + text : text;
}

[[noreturn]] void refuse(const std::string& argument, const std::string& found, const std::string& expected) {
  throw InputError("--over " + shortened(argument), 0, found, expected);
}

/// The numbers of FIRST:LAST:STEP.
std::array<Decimal, 3> parse_range(const std::string& argument, std::string_view range) {
  std::vector<Decimal> numbers;
  for (std::string_view rest = range;;) {
    const std::size_t colon = rest.find(':');
    const std::optional<Decimal> number = parse_decimal_text(rest.substr(0, colon));
    if (!number || numbers.size() == 3) {
      refuse(argument, in_quotes(range), "VALUE, FIRST:LAST or FIRST:LAST:STEP with numbers of at most 15 digits");
    }
    numbers.push_back(*number);
    if (colon == std::string_view::npos) {
      break;
    }
    rest.remove_prefix(colon + 1);
  }
  return {numbers[0], numbers.size() > 1 ? numbers[1] : numbers[0], numbers.size() > 2 ? numbers[2] : Decimal{1, 0}};
}

std::vector<std::string> values_of(const std::string& argument, std::string_view range) {
  std::array<Decimal, 3> numbers = parse_range(argument, range);
  const int decimals = std::ranges::max(numbers, {}, &Decimal::decimals).decimals;
  for (Decimal& number : numbers) {
    const std::int64_t factor = power_of_ten(decimals - number.decimals);
    if (std::abs(number.digits) > power_of_ten(static_cast<int>(max_digits) + 2) / factor) {
      refuse(argument, in_quotes(range), "numbers of similar size");
    }
    number.digits *= factor;
  }
  const auto [first, last, step] = std::array{numbers[0].digits, numbers[1].digits, numbers[2].digits};
  if (step <= 0 || last < first) {
    refuse(argument, step <= 0 ? "a step that is not above 0" : "a last value below the first", "an ascending range");
  }
  const auto count = static_cast<std::uint64_t>((last - first) / step) + 1;
  if (count > max_sweep_runs) {
    refuse(argument, std::to_string(count) + " values", "at most " + std::to_string(max_sweep_runs) + " runs");
  }
  std::vector<std::string> values;
  for (std::int64_t value = first; value <= last; value += step) {
    values.push_back(decimal_text(value, decimals));
  }
  return values;
}

/// A swept quantity that is not a parameter.
struct NamedKind {
  std::string_view name;
  SweptQuantity::Kind kind;
  std::string_view unit;
};
constexpr NamedKind named_kinds[] = {{"seed", SweptQuantity::Kind::seed, ""},
                                     {"friction", SweptQuantity::Kind::friction, ""},
                                     {"x", SweptQuantity::Kind::x, "m"},
                                     {"y", SweptQuantity::Kind::y, "m"},
                                     {"heading", SweptQuantity::Kind::heading, "deg"}};

SweptQuantity read_quantity(const std::string& argument) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || equals == 0) {
    refuse(argument, equals == 0 ? "no name" : "no '='", "NAME=FIRST:LAST:STEP");
  }
  SweptQuantity quantity;
  quantity.argument = argument;
  quantity.name = argument.substr(0, equals);
  for (const NamedKind& named : named_kinds) {
    if (named.name == quantity.name) {
      quantity.kind = named.kind;
      quantity.unit = named.unit;
    }
  }
  quantity.values = values_of(argument, std::string_view(argument).substr(equals + 1));
  return quantity;
}

/// Text of a unit; "" for a ratio, whose symbol is 1.
std::string unit_text(Unit unit) { return unit == Unit::ratio ? "" : scale_of(unit).symbol; }

/// The setting that a quantity replaces; it must be a parameter.
sim::SettingTarget target_of(const sim::Scenario& scenario, const std::string& name) {
  return sim::find_named_target(scenario, name);
}

/// Whether a setting has no effect beside a swept parameter, or the parameter has no effect beside the setting.
bool excludes(const sim::SettingTarget& swept, const sim::SettingTarget& setting) {
  if (!swept.same_value(setting) || setting.tick > 0) {
    return false;
  }
  const bool setting_is_later = setting.in_flight && !setting.internal;  // a change at tick 0
  return setting_is_later ? !(swept.joints & setting.joints).empty() : (setting.joints - swept.joints).empty();
}

/// Refuses a quantity whose value the user states elsewhere too.
void refuse_second_value(const Sweep& sweep, const SweptQuantity& quantity) {
  const auto refuse_option = [&](const std::string& option) {
    refuse(quantity.argument, option + " as well", "one of the two");
  };
  const sim::Overrides& overrides = sweep.scenario.overrides;
  if (quantity.kind == SweptQuantity::Kind::seed && overrides.seed) {
    refuse_option("--seed " + std::to_string(*overrides.seed));
  }
  if (quantity.kind == SweptQuantity::Kind::friction && overrides.friction) {
    refuse_option("--friction " + exact_text(*overrides.friction));
  }
  if ((quantity.kind == SweptQuantity::Kind::x || quantity.kind == SweptQuantity::Kind::y) && overrides.at) {
    refuse_option("--at " + *sim::words_of(overrides).at);
  }
  if (quantity.kind == SweptQuantity::Kind::heading && overrides.heading_deg) {
    refuse_option("--heading " + exact_text(*overrides.heading_deg));
  }
  if (quantity.kind != SweptQuantity::Kind::parameter) {
    return;
  }
  const sim::SettingTarget target = target_of(sweep.scenario, quantity.name);
  for (const std::string& setting : sweep.settings) {
    if (excludes(target, sim::find_target(sweep.scenario, setting))) {
      refuse_option("--set " + shortened(setting));
    }
  }
  for (const SweptQuantity& other : sweep.quantities) {
    if (other.kind == SweptQuantity::Kind::parameter && excludes(target, target_of(sweep.scenario, other.name))) {
      refuse_option("--over " + shortened(other.argument));
    }
  }
}

/// The start pose of the scenario with other overrides: the pose in its files, lifted onto the ground.
sim::Pose start_pose(const sim::Scenario& scenario, const sim::Overrides& overrides) {
  sim::SourceTexts files;
  for (const sim::SourceFile& source : scenario.sources) {
    files.add(source.path, source.text);
  }
  return sim::read_scenario(scenario.path, files, overrides).environment.robot_pose;
}

/// Changes x or y of the start position.
void set_start(sim::Scenario& scenario, Eigen::Index axis, const std::string& value) {
  sim::OverrideWords words;
  words.at = value + ",0";  // read_overrides() checks the range
  const double coordinate = sim::read_overrides(words).at->x();
  sim::Overrides& overrides = scenario.overrides;
  overrides.at = overrides.at.value_or(scenario.environment.robot_pose.position.head<2>());
  (*overrides.at)[axis] = coordinate;
  scenario.environment.robot_pose = start_pose(scenario, overrides);
}

/// Sets a value of the quantity. Throws InputError for a value that the scenario rejects.
void apply(const SweptQuantity& quantity, const std::string& value, sim::Scenario& scenario) {
  sim::OverrideWords words;
  switch (quantity.kind) {
    case SweptQuantity::Kind::parameter:
      sim::apply_setting(scenario, quantity.name + "=" + value);
      return;
    case SweptQuantity::Kind::seed:
      words.seed = value;
      scenario.kernel.seed = *sim::read_overrides(words).seed;
      return;
    case SweptQuantity::Kind::friction:
      words.friction = value;
      sim::set_friction(scenario.environment, *sim::read_overrides(words).friction);
      return;
    case SweptQuantity::Kind::x:
      set_start(scenario, 0, value);
      return;
    case SweptQuantity::Kind::y:
      set_start(scenario, 1, value);
      return;
    case SweptQuantity::Kind::heading:
      words.heading = value;
      scenario.overrides.heading_deg = sim::read_overrides(words).heading_deg;
      scenario.environment.robot_pose = start_pose(scenario, scenario.overrides);
      return;
  }
}

/// Throws InputError for a value that the scenario rejects. What needs the files read again is checked for some values,
/// with the first and the last.
void check_values(const sim::Scenario& scenario, const SweptQuantity& quantity) {
  constexpr std::size_t most_with_files = 200;
  const bool reads_files = quantity.kind == SweptQuantity::Kind::x || quantity.kind == SweptQuantity::Kind::y ||
                           quantity.kind == SweptQuantity::Kind::heading;
  const std::size_t step = reads_files ? std::max<std::size_t>(1, quantity.values.size() / most_with_files) : 1;
  sim::Scenario trial = scenario;
  for (std::size_t i = 0; i < quantity.values.size(); i += step) {
    apply(quantity, quantity.values[i], trial);
  }
  apply(quantity, quantity.values.back(), trial);
}

void refuse_twice(const Sweep& sweep, const SweptQuantity& quantity) {
  if (std::ranges::find(sweep.quantities, quantity.name, &SweptQuantity::name) != sweep.quantities.end()) {
    refuse(quantity.argument, in_quotes(quantity.name) + " twice", "each quantity once");
  }
}

void add_quantity(Sweep& sweep, SweptQuantity quantity) {
  if (sweep.size() * quantity.values.size() > max_sweep_runs) {
    refuse(quantity.argument, std::to_string(sweep.size() * quantity.values.size()) + " combinations or more",
           "at most " + std::to_string(max_sweep_runs) + " runs");
  }
  sweep.quantities.push_back(std::move(quantity));
}

}  // namespace

std::uint64_t Sweep::size() const {
  std::uint64_t size = 1;
  for (const SweptQuantity& quantity : quantities) {
    size *= quantity.values.size();
  }
  return size;
}

Candidate Sweep::combination(std::uint64_t number) const {
  Candidate indices(quantities.size());
  for (std::size_t i = quantities.size(); i-- > 0;) {
    const std::size_t count = quantities[i].values.size();
    indices[i] = static_cast<std::uint32_t>(number % count);
    number /= count;
  }
  return indices;
}

sim::Scenario Sweep::scenario_of(const Candidate& combination) const {
  sim::Scenario result = scenario;
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    apply(quantities[i], quantities[i].values[combination[i]], result);
  }
  return result;
}

Sweep read_sweep(sim::Scenario scenario, std::span<const std::string> arguments, std::vector<std::string> settings) {
  Sweep sweep{std::move(scenario), {}, std::move(settings)};
  if (arguments.empty()) {
    throw InputError("--over", 0, "no quantity", "NAME=FIRST:LAST:STEP, at least once");
  }
  for (const std::string& argument : arguments) {
    SweptQuantity quantity = read_quantity(argument);
    refuse_twice(sweep, quantity);
    check_values(sweep.scenario, quantity);
    refuse_second_value(sweep, quantity);
    if (quantity.kind == SweptQuantity::Kind::parameter) {
      quantity.unit = unit_text(target_of(sweep.scenario, quantity.name).unit);
    }
    add_quantity(sweep, std::move(quantity));
  }
  return sweep;
}

Sweep sweep_without_scenario(const SweepRequest& request) {
  Sweep sweep{{}, {}, request.settings};
  for (std::size_t i = 0; i < request.over.size(); ++i) {
    SweptQuantity quantity = read_quantity(request.over[i]);
    quantity.unit = request.units[i];
    refuse_twice(sweep, quantity);
    add_quantity(sweep, std::move(quantity));
  }
  return sweep;
}

}  // namespace proleg::optimize
