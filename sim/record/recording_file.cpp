#include "sim/record/recording_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "sim/record/schema.hpp"

namespace proleg::sim {
namespace {

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

void require_file_or_nothing(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw FileError(path, "exists and is not a file; give another name for the recording");
  }
}

/// SQLite would report a long name when it first needs a second file, at the end of a run.
void require_room_for_suffixes(const std::filesystem::path& path) {
  constexpr auto max_suffix = static_cast<long>(std::string_view("-journal").size());
  const long max_name = pathconf(folder_of(path).c_str(), _PC_NAME_MAX);
  if (max_name > 0 && static_cast<long>(path.filename().string().size()) > max_name - max_suffix) {
    throw FileError(path, "the name is too long; give the recording a name of at most " +
                              std::to_string(max_name - max_suffix) + " bytes");
  }
}

/// The next recording with the rest of the name would delete this one.
void require_no_companion(const std::filesystem::path& path) {
  for (const std::string& suffix : recording_companions()) {
    if (path.filename().string().ends_with(suffix)) {
      throw FileError(
          path, "the name ends in " + suffix + ", as a file beside a recording does; give the recording another name");
    }
  }
}

[[noreturn]] void fail_to_create(const std::filesystem::path& path) {
  throw FileError(path, std::string("cannot be created: ") + std::strerror(errno));
}

bool has_name(int descriptor, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

void lock(int descriptor, const std::filesystem::path& path) {
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
    return;
  }
  const int reason = errno;
  close(descriptor);
  throw FileError(path, reason == EWOULDBLOCK
                            ? "another program is recording into this file; give another name for the recording"
                            : std::string("cannot be locked: ") + std::strerror(reason));
}

/// The file, created if there is none, and locked.
int open_and_lock(const std::filesystem::path& path) {
  while (true) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) {
      fail_to_create(path);
    }
    lock(descriptor, path);
    // Another recorder may have replaced the file after it was opened here.
    if (has_name(descriptor, path)) {
      return descriptor;
    }
    close(descriptor);
  }
}

void remove_companions(const std::filesystem::path& path) {
  for (const std::string& suffix : recording_companions()) {
    std::error_code error;
    std::filesystem::remove(path.string() + suffix, error);
    if (error) {
      throw FileError(path, "cannot replace the earlier recording: " + error.message());
    }
  }
}

/// A new file with this name, locked. path: that of the recording, for messages.
int create_and_lock(const std::filesystem::path& name, const std::filesystem::path& path) {
  const int descriptor = open(name.c_str(), O_RDONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    fail_to_create(path);
  }
  lock(descriptor, path);
  return descriptor;
}

/// An empty file in place of a locked one, locked from before it gets the name. Programs that read the old file keep
/// it.
int replace(const std::filesystem::path& path) {
  const std::filesystem::path name = temporary_name(folder_of(path));
  const int descriptor = create_and_lock(name, path);
  if (rename(name.c_str(), path.c_str()) != 0) {
    const int reason = errno;
    close(descriptor);
    unlink(name.c_str());
    errno = reason;
    fail_to_create(path);
  }
  return descriptor;
}

/// Replaces what a locked file contains.
int empty_file(int descriptor, const std::filesystem::path& path) {
  struct stat status {};
  const bool is_empty = fstat(descriptor, &status) == 0 && status.st_size == 0;
  if (!is_empty && !is_recording(path)) {
    throw FileError(path, "exists and is not a recording; it was not changed; give another name for the recording");
  }
  remove_companions(path);
  return is_empty ? descriptor : replace(path);
}

}  // namespace

bool is_recording(const std::filesystem::path& path) {
  std::array<char, 72> header{};
  std::ifstream file(path, std::ios::binary);
  if (!file.read(header.data(), header.size())) {
    return false;
  }
  std::uint32_t application_id = 0;
  for (std::size_t i = 68; i < 72; ++i) {
    application_id = application_id << 8U | static_cast<unsigned char>(header[i]);
  }
  // The magic string is 16 bytes long with its terminating zero.
  return std::equal(header.begin(), header.begin() + 16, "SQLite format 3") &&
         application_id == recording_application_id;
}

std::vector<std::string> recording_companions() { return {"-wal", "-shm", "-journal"}; }

RecordingClaim::RecordingClaim(const std::filesystem::path& path, EarlierFile earlier) {
  require_file_or_nothing(path);
  require_room_for_suffixes(path);
  require_no_companion(path);
  if (earlier == EarlierFile::is_refused) {
    if (std::filesystem::exists(std::filesystem::symlink_status(path))) {
      throw FileError(path, "exists already; give the recording another name");
    }
    descriptor_ = create_and_lock(path, path);
    remove_companions(path);
    return;
  }
  const int found = open_and_lock(path);
  try {
    descriptor_ = empty_file(found, path);
  } catch (...) {
    close(found);
    throw;
  }
  if (descriptor_ != found) {
    close(found);
  }
}

RecordingClaim::~RecordingClaim() { close(descriptor_); }

}  // namespace proleg::sim
