#pragma once

// What the scenarios that ship with Proleg are called in the gallery.

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace proleg::tools {

struct ShippedScenario {
  std::string_view file;   ///< below sim/scenarios, without ".simulation.xml"
  std::string_view group;  ///< the heading under which it stands
  std::string_view title;
  std::string_view text;  ///< a sentence; empty: the first comment of the file says it
};

/// All of them, in the order in which they are shown; those of a group one after the other.
[[nodiscard]] std::span<const ShippedScenario> shipped_scenarios();

/// The folder sim/scenarios of the checkout in which this program was built; nothing if there is none.
[[nodiscard]] std::optional<std::filesystem::path> shipped_folder();

}  // namespace proleg::tools
