#pragma once

// The scenarios that ship with Proleg: what they are called on a command line and in the gallery of the page.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

/// How the names of scenario files end.
inline constexpr const char* scenario_extension = ".simulation.xml";

struct ShippedScenario {
  std::string_view name;   ///< on a command line; no other one has it
  std::string_view file;   ///< below shipped_folder(), without scenario_extension
  std::string_view group;  ///< the heading under which it stands
  std::string_view title;
  std::string_view text;  ///< a sentence; empty: the first comment of the file says it
};

/// All of them, in the order in which they are shown; those of a group one after the other.
[[nodiscard]] std::span<const ShippedScenario> shipped_scenarios();

/// The file that a word of a command line means: the word itself if there is such a file or folder; else the file of
/// the shipped scenario that has this name, or this place below shipped_folder(). Throws InputError for a word that is
/// neither, unless it has the form of a path.
[[nodiscard]] std::string scenario_file(const std::string& word);
/// The same with shipped scenarios in another folder; nothing: there are none.
[[nodiscard]] std::string scenario_file(const std::string& word, const std::optional<std::filesystem::path>& folder);

/// Adds the positional argument FILE for a scenario. `file` has the value of scenario_file() when the body of the
/// program runs.
CommandLine::Option add_scenario(CommandLine& command_line, std::string& file, const std::string& help);

}  // namespace proleg::tools
