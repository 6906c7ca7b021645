#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// A file to write.
struct FileCopy {
  std::filesystem::path place;  ///< relative path
  std::string text;
};

/// The robot and environment files of a scenario and all that they include, with places below one folder where their
/// references are valid.
struct ScenarioFiles {
  std::filesystem::path robot;
  std::filesystem::path environment;
  std::vector<FileCopy> copies;  ///< the robot and environment files, and all that they include
};

/// Collects the files. Below `root` they have the same paths as below their deepest common folder, so equal names in
/// different folders do not collide. Texts are copied byte by byte. Only paths that would become invalid are replaced
/// (absolute ones, and those relative to the folder of the top-level file), and an overridden engine. The scenario must
/// have been read from files.
[[nodiscard]] ScenarioFiles collect_scenario_files(const sim::Scenario& scenario, const std::filesystem::path& root);

}  // namespace proleg::optimize
