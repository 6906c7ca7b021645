#pragma once

#include <filesystem>

namespace proleg::tools {

/// A new folder for files of this program, among the system's temporary files. It is removed with this object.
class ScratchFolder {
 public:
  /// Throws std::runtime_error if it cannot be made.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace proleg::tools
