#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace proleg::sim {

/// Whether a file starts as a recording does.
[[nodiscard]] bool is_recording(const std::filesystem::path& path);

/// Suffixes of the files that a recorder has beside a recording.
[[nodiscard]] std::vector<std::string> recording_companions();

/// What happens to an empty file or an earlier recording in the place of a new one. Any other file is never replaced.
enum class EarlierFile { is_replaced, is_refused };

/// An empty file for a new recording, which no other recorder can claim while this object exists.
///
/// The lock is on the file itself (flock), so it ends with the process, and SQLite's own locks do not meet it.
class RecordingClaim {
 public:
  /// Throws FileError for an existing file that is not replaced, for a recording that another recorder has claimed, for
  /// a name that ends as those of recording_companions(), and if the system cannot create the file. A file is refused
  /// with its links, also with those that lead nowhere.
  explicit RecordingClaim(const std::filesystem::path& path, EarlierFile earlier = EarlierFile::is_replaced);
  ~RecordingClaim();
  RecordingClaim(const RecordingClaim&) = delete;
  RecordingClaim& operator=(const RecordingClaim&) = delete;

 private:
  int descriptor_;
};

}  // namespace proleg::sim
