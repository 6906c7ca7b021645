#pragma once

// The mesh files that a URDF file names: where they are on this computer, and what they are called in a scenario.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/scenario/sources.hpp"

namespace proleg::sim {

/// Folders of ROS packages by their names.
using PackageFolders = std::map<std::string, std::filesystem::path>;

struct FoundMesh {
  std::filesystem::path path;
  SharedText bytes;
};

/// Finds a mesh: package://NAME/path (and model://NAME/path), file://path or a path, relative to the folder of the URDF
/// file. The folder of a package is the one in `packages`; otherwise, from the folder of the URDF file upwards, a
/// folder with that name, or with a package.xml that has it. Nothing if no such file can be read.
[[nodiscard]] std::optional<FoundMesh> find_mesh(const std::string& name, const std::filesystem::path& urdf,
                                                 const PackageFolders& packages, FileSource& files);

/// What a message says that is expected where find_mesh() finds nothing.
[[nodiscard]] std::string expected_mesh(const std::string& name);

/// The meshes of a scenario that is made of a URDF file. Each folder of them becomes one of its own, so that the files
/// beside a mesh keep their names.
class ImportedMeshes {
 public:
  /// packages, files: must outlive this object.
  ImportedMeshes(std::filesystem::path urdf, const PackageFolders& packages, FileSource& files)
      : urdf_(std::move(urdf)), packages_(&packages), source_(&files) {}

  /// The path of a mesh in the scenario: meshes/FILE or, from another folder, meshes2/FILE. Nothing if find_mesh()
  /// finds none.
  [[nodiscard]] std::optional<std::string> file_of(const std::string& mesh);
  /// All meshes that were asked for, with the files that they name for their colours.
  [[nodiscard]] const std::vector<SourceFile>& files() const { return files_; }

 private:
  void add_materials(const std::filesystem::path& folder, const std::string& target, const std::string& text);
  void add_file(const std::string& name, SharedText text);

  std::filesystem::path urdf_;
  const PackageFolders* packages_;
  FileSource* source_;
  std::vector<SourceFile> files_;
  std::map<std::string, std::optional<std::string>> names_;  ///< by the name in the URDF file
  std::map<std::string, std::size_t> folders_;               ///< numbers, from 1
};

}  // namespace proleg::sim
