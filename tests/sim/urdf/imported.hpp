#pragma once

#include <filesystem>
#include <string>

#include "sim/scenario/reader.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/urdf/urdf_import.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {

/// The import of a text, as that of the file robot.urdf.
inline UrdfImport import_text(const std::string& text, const UrdfImportOptions& options = {}) {
  SourceTexts files;
  files.add("robot.urdf", text);
  return import_urdf("robot.urdf", files, options);
}

/// The text of a file in tests/sim/urdf/robots.
inline std::string robot_text(const std::string& name) {
  return file_contents(source_path("/tests/sim/urdf/robots/" + name + ".urdf"));
}

inline Scenario scenario_of(const UrdfImport& import) {
  SourceTexts files;
  for (const SourceFile& file : import.files) {
    files.add(file.path, file.text);
  }
  return read_scenario(import.files.front().path, files);
}

inline std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    text += line + '\n';
  }
  return text;
}

}  // namespace proleg::sim
