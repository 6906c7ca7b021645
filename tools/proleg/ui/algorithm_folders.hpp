#pragma once

// The algorithms of a person's own in a project folder: each in a folder of its own, as `proleg new algorithm` writes
// it. Nothing outside of the project folder is read or written, also not by symbolic links.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/new/algorithm_form.hpp"

namespace proleg::tools {

struct AlgorithmFolder {
  std::string folder;            ///< name in the project folder; ".": the project folder itself
  std::string name;              ///< of the algorithm: that of its source
  std::filesystem::path path;    ///< absolute
  std::filesystem::path source;  ///< NAME.cpp

  /// Where the page builds it, as docs/user-algorithms.md does.
  [[nodiscard]] std::filesystem::path build() const { return path / "build"; }
  [[nodiscard]] std::filesystem::path library() const { return build() / (name + ".so"); }
};

/// A source as it is on disk.
struct SourceText {
  std::string text;
  std::string version;  ///< names the text: equal texts have equal versions
};

class AlgorithmFolders {
 public:
  static constexpr std::size_t most_source_bytes = std::size_t{256} * 1024;
  static constexpr std::size_t most_folders = 200;

  /// project: a folder that exists.
  explicit AlgorithmFolders(const std::filesystem::path& project);

  /// All of them, by name.
  [[nodiscard]] std::vector<AlgorithmFolder> list() const;
  /// The one whose source has this name, if there is one.
  [[nodiscard]] std::optional<AlgorithmFolder> with_name(const std::string& name) const;
  /// Throws InputError if there is no algorithm in a folder of this name.
  [[nodiscard]] AlgorithmFolder find(const std::string& folder) const;

  /// Writes the files of a new one into a new folder with its name. source_tree: sources of Proleg. Throws InputError
  /// for a form that breaks a rule, or if the folder exists; FileError, and then there is no new folder.
  AlgorithmFolder create(const AlgorithmForm& form, const std::filesystem::path& source_tree) const;

  /// Throws InputError if the source is no text, or too long; FileError.
  [[nodiscard]] static SourceText read(const AlgorithmFolder& algorithm);
  /// Writes the source, and returns its version. version: of the text that was changed. Throws InputError if the file
  /// has another text now, and writes nothing; FileError.
  static std::string write(const AlgorithmFolder& algorithm, const std::string& text, const std::string& version);

 private:
  std::filesystem::path project_;  ///< without symbolic links
};

}  // namespace proleg::tools
