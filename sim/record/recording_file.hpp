#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace proleg::sim {

/// Whether a file starts as a recording does.
[[nodiscard]] bool is_recording(const std::filesystem::path& path);

/// Suffixes of the files that a recorder has beside a recording.
[[nodiscard]] std::vector<std::string> recording_companions();

/// An empty file for a new recording, which no other recorder can claim while this object exists. Replaces an empty
/// file or an earlier recording.
///
/// The lock is on the file itself (flock), so it ends with the process, and SQLite's own locks do not meet it.
class RecordingClaim {
 public:
  /// Throws FileError for any other existing file, for a recording that another recorder has claimed, and if the system
  /// cannot create the file.
  explicit RecordingClaim(const std::filesystem::path& path);
  ~RecordingClaim();
  RecordingClaim(const RecordingClaim&) = delete;
  RecordingClaim& operator=(const RecordingClaim&) = delete;

 private:
  int descriptor_;
};

}  // namespace proleg::sim
