#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace proleg::sim {

/// A file that cannot be written or read although the request was right: a full disk, a read-only folder, a device
/// error. what() is one line: the path and what happened.
class RecordError : public std::runtime_error {
 public:
  RecordError(const std::filesystem::path& path, const std::string& what)
      : std::runtime_error(path.string() + ": " + what) {}
};

}  // namespace proleg::sim
