#pragma once

// Makes a scenario of a robot in URDF: its robot file with the meshes, a first gait, a flat floor.

#include <filesystem>
#include <string>
#include <vector>

#include "sim/scenario/sources.hpp"
#include "sim/urdf/mesh_places.hpp"

namespace proleg::sim {

struct UrdfImport {
  std::vector<SourceFile> files;      ///< paths relative to their folder; the top-level file is the first one
  std::vector<std::string> notes;     ///< what was chosen because the file does not say it, one line each
  std::vector<std::string> lost;      ///< what the file has and Proleg has not, one line each
  std::vector<std::string> warnings;  ///< what is probably not meant, with file and line
};

struct UrdfImportOptions {
  PackageFolders packages;
  double density = 1000.0;  ///< kg/m^3, of bodies without <inertial>; above 0
};

/// Reads the URDF file `path` from `files`. The scenario reader has accepted the result. Throws InputError, with the
/// lines of the URDF file.
[[nodiscard]] UrdfImport import_urdf(const std::filesystem::path& path, FileSource& files,
                                     const UrdfImportOptions& options = {});

}  // namespace proleg::sim
