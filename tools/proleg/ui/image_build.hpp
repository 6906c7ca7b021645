#pragma once

// The image for the modules with algorithms of users: how it is built, and what came out (docs/user-algorithms.md).

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/proleg/ui/algorithm_folders.hpp"

namespace proleg::tools {

class ImageBuild {
 public:
  /// project: its folder. The build is kept in build/image, so the next one takes less time.
  explicit ImageBuild(const std::filesystem::path& project) : folder_(project / "build/image") {}

  /// Makes the folder, and returns the programs that build the image with these algorithms; they run in the folder of
  /// the sources. Throws InputError for a path that CMake cannot take, FileError if the folder cannot be made,
  /// std::runtime_error without the compiler.
  [[nodiscard]] std::vector<std::vector<std::string>> commands(std::span<const AlgorithmFolder> algorithms) const;

  /// The built image, for the document `algorithm_image`. Throws InputError if it is not there, or not intact.
  [[nodiscard]] nlohmann::json described(std::span<const AlgorithmFolder> algorithms) const;

  /// Removes the image that a failed build has left, so that it is not flashed.
  void discard() const;

  /// Why a build has failed, in a line; output: of its programs. Empty if only the compiler's messages say it.
  [[nodiscard]] std::string problem(std::string_view output) const;

 private:
  [[nodiscard]] std::filesystem::path program(const char* extension) const;

  std::filesystem::path folder_;
};

}  // namespace proleg::tools
