#pragma once

// A `--set` word, [MODULE.]NAME[:JOINT]=VALUE[@TICK], and what it means in a scenario. reader.hpp says what its parts
// are.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/scenario/reader.hpp"

namespace proleg::sim {

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
