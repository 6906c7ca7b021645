#pragma once

// Settings of a scenario: their texts, `--set` words and start values.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "shared/fixed/unit.hpp"
#include "shared/gait/declaration.hpp"
#include "shared/gait/joint_mask.hpp"
#include "shared/kernel/kernel_configuration.hpp"
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

/// Calls visit(joint, values) with the values of all parameters of a used slot on each joint that it drives: those at
/// the start, then those after each change of a parameter.
void visit_parameter_values(
    const Scenario& scenario, unsigned slot,
    const std::function<void(unsigned joint, const std::array<std::int32_t, max_parameters>& values)>& visit);

/// Values of parameters that contradict each other, for a message.
struct FoundContradiction {
  unsigned slot = 0;
  std::string found;     ///< algorithm, values and joint
  std::string expected;  ///< what would be right
};
/// The first contradiction among the values of the start, or after a change.
[[nodiscard]] std::optional<FoundContradiction> find_contradiction(const Scenario& scenario);

/// The tick that a word of the command line names behind its '@': a whole number, or seconds with an `s`, which mean
/// the tick that begins then, or next. Throws InputError with the word as its file.
[[nodiscard]] std::uint32_t read_tick(const std::string& word, const std::string& tick, std::uint32_t tick_period_us);

/// Applies a `--set` word to a scenario: [MODULE.]NAME[:JOINT]=VALUE[@TICK]
///   MODULE  name of an algorithm, or 1 to 4 for its position in the actuation file; required if several modules that
///           drive the joint have a value of that name
///   NAME    a parameter, or an internal value
///   JOINT   a joint of the robot file; without it all joints of the module
///   VALUE   a decimal number in the declared unit
///   TICK    0 to 2^32 - 1
/// A parameter without a tick gets a new start value; with a tick it changes while the robot moves. An internal value
/// is overwritten (a distortion) at the tick, by default 0. Throws InputError with the word as its file, and then does
/// not change the scenario.
void apply_setting(Scenario& scenario, const std::string& word);

/// The values that a `--set` word changes.
struct SettingTarget {
  unsigned slot = 0;
  bool internal = false;
  unsigned number = 0;     ///< of the parameter or internal value in the declaration
  JointMask joints;        ///< kernel order, at least one
  bool in_flight = false;  ///< as a change at the tick; otherwise a start value
  std::uint32_t tick = 0;  ///< of the change; 0 for a start value
  Unit unit = Unit::count;

  [[nodiscard]] bool same_value(const SettingTarget& other) const {
    return slot == other.slot && internal == other.internal && number == other.number;
  }
};

/// Does not look at the VALUE of the word. Throws InputError as apply_setting() does.
[[nodiscard]] SettingTarget find_target(const Scenario& scenario, const std::string& word);

/// The part of a word before '=', taken apart.
struct SettingName {
  std::optional<std::string> module;
  std::string name;
  std::optional<std::string> joint;
};
[[nodiscard]] SettingName parse_setting_name(const std::string& text);

/// What a name means: [MODULE.]NAME[:JOINT]. Throws InputError as apply_setting() does.
[[nodiscard]] SettingTarget find_named_target(const Scenario& scenario, const std::string& name);

/// What a word asks for.
struct ParsedSetting {
  std::string word;                   ///< shortened, for messages
  std::vector<Setting> settings;      ///< the value for each joint that the word means
  std::optional<std::uint32_t> tick;  ///< nothing: the word has none
};
/// Throws InputError as apply_setting() does.
[[nodiscard]] ParsedSetting parse_setting(const Scenario& scenario, const std::string& word);

/// Adds the values of a word to those that take effect together. Throws InputError if a joint would have more of them
/// than a module keeps, and then adds nothing. when: for the message, such as " at tick 5".
void add_settings(const Scenario& scenario, const ParsedSetting& parsed, std::vector<Setting>& together,
                  const std::string& when = {});

}  // namespace proleg::sim
