#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The files of a scenario that a teacher gives to a class.
class HandOut {
 public:
  /// Reads the scenario. Throws InputError.
  explicit HandOut(const std::filesystem::path& file);

  /// The name of the scenario, without ".simulation.xml".
  [[nodiscard]] const std::string& title() const { return title_; }
  /// Copies the files into a new folder below this one, which has the title as its name, with a number if there is such
  /// a folder. Returns the path of the scenario in `folder`. Throws FileError.
  [[nodiscard]] std::filesystem::path copy_to(const std::filesystem::path& folder) const;
  /// The same; but if there is a folder with the title that has the scenario, this one.
  [[nodiscard]] std::filesystem::path copy_once_to(const std::filesystem::path& folder) const;

 private:
  std::string title_;
  std::vector<sim::SourceFile> sources_;
  std::filesystem::path place_;  ///< of the scenario below the common folder of all files
};

}  // namespace proleg::tools
