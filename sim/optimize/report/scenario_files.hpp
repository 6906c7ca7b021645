#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// A file to be written.
struct FileCopy {
  std::filesystem::path place;  ///< relative
  std::string text;
};

/// The robot and environment files of a scenario and all that they include, with places below one folder where they
/// find each other.
struct ScenarioFiles {
  std::filesystem::path robot;
  std::filesystem::path environment;
  std::vector<FileCopy> copies;  ///< these two and what they include
};

/// The files lie below `root` as they lie below their deepest common folder now, so same names in different folders
/// stay apart. Texts are copied byte by byte; only where a path would no longer lead to its file (an absolute one, or
/// one that is looked for from the folder of the top-level file) it is replaced. scenario: read from files.
[[nodiscard]] ScenarioFiles collect_scenario_files(const sim::Scenario& scenario, const std::filesystem::path& root);

}  // namespace proleg::optimize
