#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace proleg {

/// A file that cannot be written or read although the request is right: a full disk, a read-only folder, a device
/// error. what() is one line: the path and the error.
class FileError : public std::runtime_error {
 public:
  FileError(const std::filesystem::path& path, const std::string& what)
      : std::runtime_error(path.string() + ": " + what) {}
};

}  // namespace proleg
