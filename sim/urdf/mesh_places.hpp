#pragma once

// The mesh files that a URDF file names: where they are on this computer, and what they are called in a scenario.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sim/scenario/sources.hpp"

namespace proleg::sim {

/// Folders of ROS packages by their names.
using PackageFolders = std::map<std::string, std::filesystem::path>;

struct FoundMesh {
  std::filesystem::path path;
  std::filesystem::path root;  ///< the folder that the file should be in: of the package, or of the robot
  SharedText bytes;
  bool is_respelled = false;  ///< the file has other capitals, or the name has backslashes
};

/// Finds a mesh: package://NAME/path (and model://NAME/path), file://path or a path, relative to the folder of the URDF
/// file. The folder of a package is the one in `packages`; otherwise, from the folder of the URDF file upwards, a
/// folder with that name, or with a package.xml that has it. If there is no such file, names count as on Windows:
/// without capitals, and a backslash is a slash. Nothing if no such file can be read.
[[nodiscard]] std::optional<FoundMesh> find_mesh(const std::string& name, const std::filesystem::path& urdf,
                                                 const PackageFolders& packages, FileSource& files);

/// Texts of a scenario, which keep the meshes that were read.
class ImportedTexts final : public FileSource {
 public:
  ImportedTexts(const std::vector<SourceFile>& files, KnownMeshes& meshes);
  [[nodiscard]] std::optional<SharedText> read(const std::filesystem::path& path) override { return texts_.read(path); }
  [[nodiscard]] KnownMeshes* known_meshes() override { return meshes_; }

 private:
  SourceTexts texts_;
  KnownMeshes* meshes_;
};

/// The meshes of a scenario that is made of a URDF file. Each folder of them becomes one of its own, so that the files
/// beside a mesh keep their names.
class ImportedMeshes {
 public:
  /// packages, files: must outlive this object.
  ImportedMeshes(std::filesystem::path urdf, const PackageFolders& packages, FileSource& files)
      : urdf_(std::move(urdf)), packages_(&packages), source_(&files) {}

  /// A mesh as it is in the scenario, or why it is not there.
  struct Named {
    std::string file;     ///< meshes/FILE or, from another folder, meshes2/FILE; empty: there is none
    std::string problem;  ///< then: "found ..., expected ..."
  };
  [[nodiscard]] Named touching(const std::string& mesh);
  /// A mesh that is only shown, at this scale. Without one that cannot be shown a robot moves as with it.
  [[nodiscard]] Named shown(const std::string& mesh, const Eigen::Vector3d& scale);

  /// All meshes of the scenario, with the files that they name for their colours.
  [[nodiscard]] const std::vector<SourceFile>& files() const { return files_; }
  /// A scenario is read more than once; each of its meshes is imported once.
  [[nodiscard]] KnownMeshes& known_meshes() { return known_meshes_; }
  /// What was chosen, one line each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /// Meshes that were copied from elsewhere.
  [[nodiscard]] const std::vector<std::string>& outside() const { return outside_; }

 private:
  struct Candidate {
    Named named;
    std::string expected;           ///< if there is no such file
    std::vector<SourceFile> files;  ///< the mesh, and what it names
  };

  [[nodiscard]] const Candidate& candidate(const std::string& mesh);
  void add_materials(const std::filesystem::path& folder, const std::string& target, const std::string& text,
                     std::vector<SourceFile>& files);
  [[nodiscard]] std::string expected(const std::string& mesh);
  void use(const Candidate& mesh);

  std::filesystem::path urdf_;
  const PackageFolders* packages_;
  FileSource* source_;
  std::vector<SourceFile> files_;
  std::map<std::string, Candidate> candidates_;  ///< by the name in the URDF file
  std::map<std::string, std::size_t> folders_;   ///< numbers, from 1
  KnownMeshes known_meshes_;
  std::vector<std::string> notes_;
  std::vector<std::string> outside_;
};

}  // namespace proleg::sim
