#include "sim/scenario/settings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/kernel/joint_memory.hpp"
#include "sim/scenario/names.hpp"

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

void visit_parameter_values(
    const Scenario& scenario, unsigned slot,
    const std::function<void(unsigned joint, const std::array<std::int32_t, max_parameters>& values)>& visit) {
  const Slot& visited = scenario.kernel.slots[slot];
  for (const unsigned joint : visited.driven_joints()) {
    std::array<std::int32_t, max_parameters> values{};
    for (unsigned i = 0; i < visited.algorithm->declaration().parameters.size(); ++i) {
      values[i] = start_value(scenario, slot, joint, i);
    }
    visit(joint, values);
    for (const Change& change : scenario.changes) {
      bool is_changed = false;
      for (const Setting& setting : change.settings) {
        if (setting.slot == slot && setting.joint == joint && !setting.internal) {
          values[setting.number] = setting.value;
          is_changed = true;
        }
      }
      if (is_changed) {
        visit(joint, values);
      }
    }
  }
}

std::optional<FoundContradiction> find_contradiction(const Scenario& scenario) {
  std::optional<FoundContradiction> first;
  for (const unsigned slot : used_slots(scenario)) {
    const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
    if (declaration.rules == nullptr) {
      continue;
    }
    visit_parameter_values(scenario, slot, [&](unsigned joint, const auto& values) {
      const auto found = declaration.rules->contradiction(values.data());
      if (!found || first) {
        return;
      }
      const auto shown = [&](unsigned number) {
        const Parameter& parameter = declaration.parameters[number];
        return std::string(parameter.name) + " " + std::string(format_decimal(values[number], parameter.unit).view());
      };
      first = FoundContradiction{slot,
                                 slot_name(scenario, slot) + " with " + shown(found->parameter) + " and " +
                                     shown(found->other) + " on joint " + in_quotes(scenario.robot.joints[joint].name),
                                 std::string(std::string_view(found->expected))};
    });
  }
  return first;
}

std::uint32_t read_tick(const std::string& word, const std::string& tick, std::uint32_t tick_period_us) {
  if (tick.ends_with('s')) {
    const std::optional<double> seconds = parse_number(std::string_view(tick).substr(0, tick.size() - 1));
    constexpr double longest = 1e7;
    if (!seconds || *seconds < 0 || *seconds > longest) {
      throw InputError(shortened(word), 0, "time " + in_quotes(tick), "seconds from 0 to 10000000, such as 5s");
    }
    constexpr double tolerance = 1e-6;  // 0.07 s are seven ticks of 10 ms
    return static_cast<std::uint32_t>(std::ceil(*seconds * 1e6 / tick_period_us - tolerance));
  }
  const std::optional<std::uint32_t> number = parse_whole<std::uint32_t>(tick);
  if (!number) {
    throw InputError(shortened(word), 0, "tick " + in_quotes(tick),
                     "a whole number from 0 to 4294967295, or seconds such as 5s");
  }
  return *number;
}

namespace {

/// A word taken apart.
struct SettingWord : SettingName {
  std::string word;
  std::string value;
  std::optional<std::string> tick;

  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const {
    throw InputError(shortened(word), 0, found, expected);
  }
};

SettingWord take_apart(const std::string& text) {
  SettingWord word{{}, text, {}, {}};
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) {
    word.refuse("no '='", "[MODULE.]NAME[:JOINT]=VALUE[@TICK]");
  }
  static_cast<SettingName&>(word) = parse_setting_name(text.substr(0, equals));
  word.value = text.substr(equals + 1);
  if (const std::size_t at = word.value.find('@'); at != std::string::npos) {
    word.tick = word.value.substr(at + 1);
    word.value.resize(at);
  }
  return word;
}

/// The parameter or internal value that a name means in a slot.
struct Meaning {
  unsigned slot;
  bool internal;
  unsigned number;
};

class Resolver {
 public:
  Resolver(const Scenario& scenario, const SettingWord& word) : scenario_(&scenario), word_(&word) {}

  /// The kernel joint of the word; -1 for all joints.
  [[nodiscard]] int joint() const {
    if (!word_->joint) {
      return -1;
    }
    const int joint = find_joint(scenario_->robot, *word_->joint);
    if (joint < 0) {
      word_->refuse("unknown joint " + in_quotes(*word_->joint), "one of " + listed(joint_names(scenario_->robot)));
    }
    return joint;
  }

  [[nodiscard]] Meaning meaning(int joint) const {
    const std::vector<unsigned> slots = candidate_slots();
    std::vector<Meaning> meanings = find(slots, false);
    if (meanings.empty()) {
      meanings = find(slots, true);
    }
    if (meanings.empty()) {
      refuse_name(slots);
    }
    if (joint >= 0) {
      const unsigned slot = meanings.front().slot;
      std::erase_if(meanings, [this, joint](const Meaning& meaning) {
        return !scenario_->kernel.slots[meaning.slot].group.contains(static_cast<unsigned>(joint));
      });
      if (meanings.empty()) {
        word_->refuse(
            "joint " + in_quotes(*word_->joint) + ", which " + slot_name(*scenario_, slot) + " does not drive",
            "one of " + listed(joint_names(scenario_->robot, scenario_->kernel.slots[slot].group)));
      }
    }
    if (meanings.size() > 1) {
      std::vector<std::string> names;
      names.reserve(meanings.size());
      for (const Meaning& meaning : meanings) {
        names.push_back(std::to_string(meaning.slot + 1) + '.' + shortened(word_->name) + " (" +
                        std::string(declaration(meaning.slot).name) + ')');
      }
      word_->refuse(in_quotes(word_->name) + " in several modules", "one of " + listed(names));
    }
    return meanings.front();
  }

 private:
  [[nodiscard]] const Declaration& declaration(unsigned slot) const {
    return scenario_->kernel.slots[slot].algorithm->declaration();
  }

  [[nodiscard]] std::vector<unsigned> candidate_slots() const {
    std::vector<unsigned> slots = word_->module ? find_slots(*scenario_, *word_->module) : used_slots(*scenario_);
    if (slots.empty()) {
      word_->refuse(word_->module ? "unknown module " + in_quotes(*word_->module) : "a scenario without modules",
                    "one of " + listed(slot_names(*scenario_)));
    }
    return slots;
  }

  [[nodiscard]] std::vector<Meaning> find(const std::vector<unsigned>& slots, bool internal) const {
    std::vector<Meaning> meanings;
    for (const unsigned slot : slots) {
      const int number = internal ? find_internal_value(declaration(slot), word_->name)
                                  : find_named_parameter(declaration(slot), word_->name);
      if (number >= 0) {
        meanings.push_back({slot, internal, static_cast<unsigned>(number)});
      }
    }
    return meanings;
  }

  [[noreturn]] void refuse_name(const std::vector<unsigned>& slots) const {
    std::vector<std::string> parameters;
    std::vector<std::string> internal_values;
    const auto add = [](std::vector<std::string>& names, std::string_view name) {
      if (std::ranges::find(names, name) == names.end()) {
        names.emplace_back(name);
      }
    };
    for (const unsigned slot : slots) {
      for (const Parameter& parameter : declaration(slot).parameters) {
        add(parameters, parameter.name);
      }
      for (const InternalValue& value : declaration(slot).internal_values) {
        add(internal_values, value.name);
      }
    }
    word_->refuse("unknown parameter " + in_quotes(word_->name),
                  "one of " + listed(parameters) +
                      (internal_values.empty() ? "" : ", or of the internal values " + listed(internal_values)) +
                      hint_on_thesis_name(scenario_->robot, parameters, word_->name));
  }

  const Scenario* scenario_;
  const SettingWord* word_;
};

std::int32_t parse_internal_value(const InternalValue& internal, const SettingWord& word) {
  const DecimalResult result = parse_decimal(word.value, internal.unit);
  if (result.error != DecimalError::none) {
    word.refuse(in_quotes(word.value) + " for " + in_quotes(internal.name), unit_range_text(internal.unit));
  }
  return result.raw;
}

/// "Joint_0" as the word that Proleg has for it, "angle:J1". A parameter that is called so comes first.
SettingWord with_own_names(const Scenario& scenario, SettingWord word) {
  const int joint = word.joint ? -1 : find_joint_of_thesis(scenario.robot, word.name);
  const auto is_declared = [&](std::string_view name) {
    return std::ranges::any_of(used_slots(scenario), [&](unsigned slot) {
      return find_parameter(scenario.kernel.slots[slot].algorithm->declaration(), name) >= 0;
    });
  };
  if (joint >= 0 && !is_declared(word.name) && is_declared("angle")) {
    word.name = "angle";
    word.joint = scenario.robot.joints[static_cast<std::size_t>(joint)].name;
  }
  return word;
}

SettingTarget target_of(const Scenario& scenario, const SettingWord& given) {
  const SettingWord word = with_own_names(scenario, given);
  const Resolver resolver(scenario, word);
  const int joint = resolver.joint();
  const Meaning meaning = resolver.meaning(joint);
  const Slot& slot = scenario.kernel.slots[meaning.slot];
  const Declaration& declaration = slot.algorithm->declaration();
  SettingTarget target;
  target.slot = meaning.slot;
  target.internal = meaning.internal;
  target.number = meaning.number;
  for (unsigned j = 0; j < scenario.kernel.joint_count; ++j) {
    if (slot.group.contains(j) && (joint < 0 || j == static_cast<unsigned>(joint))) {
      target.joints.insert(j);
    }
  }
  target.in_flight = meaning.internal || word.tick.has_value();
  target.tick = word.tick ? read_tick(word.word, *word.tick, scenario.kernel.tick_period_us) : 0;
  target.unit =
      meaning.internal ? declaration.internal_values[meaning.number].unit : declaration.parameters[meaning.number].unit;
  return target;
}

Change& change_at(std::vector<Change>& changes, std::uint32_t tick) {
  const auto position = std::ranges::lower_bound(changes, tick, {}, &Change::tick);
  if (position != changes.end() && position->tick == tick) {
    return *position;
  }
  return *changes.insert(position, Change{tick, {}});
}

}  // namespace

SettingName parse_setting_name(const std::string& text) {
  SettingName parts{{}, text, {}};
  std::size_t colon = text.find(':');
  if (colon != std::string::npos && text.substr(colon).starts_with(": ")) {  // the thesis's "amplitude: a"
    colon = text.find(':', colon + 1);
  }
  if (colon != std::string::npos) {
    parts.joint = std::string(trimmed(std::string_view(text).substr(colon + 1)));
    parts.name.resize(colon);
  }
  if (const std::size_t dot = parts.name.find('.'); dot != std::string::npos) {
    parts.module = parts.name.substr(0, dot);
    parts.name.erase(0, dot + 1);
  }
  return parts;
}

ParsedSetting parse_setting(const Scenario& scenario, const std::string& text) {
  const SettingWord word = take_apart(text);
  const SettingTarget target = target_of(scenario, word);
  if (target.joints.empty()) {
    throw InputError(shortened(text), 0,
                     "actuation module " + std::to_string(target.slot + 1) + ", which drives no joint",
                     "one that drives the joints that are to change");
  }
  const Declaration& declaration = scenario.kernel.slots[target.slot].algorithm->declaration();

  Setting setting;
  setting.slot = static_cast<std::uint8_t>(target.slot);
  setting.number = static_cast<std::uint8_t>(target.number);
  setting.internal = target.internal;
  setting.value = target.internal
                      ? parse_internal_value(declaration.internal_values[target.number], word)
                      : parse_parameter(declaration.parameters[target.number], word.value, shortened(word.word), 0);
  ParsedSetting parsed;
  parsed.word = shortened(text);
  for (const unsigned joint : target.joints) {
    setting.joint = static_cast<std::uint8_t>(joint);
    parsed.settings.push_back(setting);
  }
  if (word.tick) {
    parsed.tick = target.tick;
  }
  return parsed;
}

void add_settings(const Scenario& scenario, const ParsedSetting& parsed, std::vector<Setting>& together,
                  const std::string& when) {
  std::vector<Setting> all = together;
  for (const Setting& setting : parsed.settings) {
    put_setting(all, setting);
    const auto of_joint = std::ranges::count(all, setting.joint, &Setting::joint);
    if (of_joint > static_cast<std::ptrdiff_t>(max_staged_values)) {
      throw InputError(parsed.word, 0,
                       "more than " + std::to_string(max_staged_values) + " values for joint " +
                           in_quotes(scenario.robot.joints[setting.joint].name) + when,
                       "at most " + std::to_string(max_staged_values) + ", the memory of a module");
    }
  }
  together = std::move(all);
}

void apply_setting(Scenario& scenario, const std::string& text) {
  const ParsedSetting parsed = parse_setting(scenario, text);
  if (parsed.tick || parsed.settings.front().internal) {
    const std::uint32_t tick = parsed.tick.value_or(0);
    const auto change = std::ranges::find(scenario.changes, tick, &Change::tick);
    std::vector<Setting> settings = change == scenario.changes.end() ? std::vector<Setting>() : change->settings;
    add_settings(scenario, parsed, settings, " at tick " + std::to_string(tick));
    change_at(scenario.changes, tick).settings = std::move(settings);
    return;
  }
  for (const Setting& setting : parsed.settings) {
    set_start_value(scenario, setting);
  }
}

SettingTarget find_target(const Scenario& scenario, const std::string& word) {
  return target_of(scenario, take_apart(word));
}

SettingTarget find_named_target(const Scenario& scenario, const std::string& name) {
  SettingWord word{{}, name, {}, {}};
  static_cast<SettingName&>(word) = parse_setting_name(name);
  return target_of(scenario, word);
}

}  // namespace proleg::sim
