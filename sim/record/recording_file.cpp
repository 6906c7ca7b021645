#include "sim/record/recording_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "shared/computer/errors/file_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "sim/record/schema.hpp"

namespace proleg::sim {
namespace {

/// Whether the file starts as an SQLite database with the application id of a recording.
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

/// A recorder has a write transaction open all the time, so its lock shows that it is recording.
bool is_being_recorded(const std::filesystem::path& path) {
  try {
    Database database(path, SQLITE_OPEN_READWRITE);
    sqlite3_busy_timeout(database.handle(), 0);
    database.execute("BEGIN IMMEDIATE; ROLLBACK");
    return false;
  } catch (const SqliteError& error) {
    return error.code() == SQLITE_BUSY;  // any other error: a damaged recording, which may be replaced
  }
}

void remove_earlier_recording(const std::filesystem::path& path, const std::filesystem::file_status& status) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(status)) {
    throw FileError(path, "exists and is not a file; give another name for the recording");
  }
  const bool empty = std::filesystem::file_size(path, error) == 0 && !error;
  if (!empty && !is_recording(path)) {
    throw FileError(path, "exists and is not a recording; it was not changed; give another name for the recording");
  }
  if (!empty && is_being_recorded(path)) {
    throw FileError(path, "another program is recording into this file; give another name for the recording");
  }
  for (const char* suffix : {"-wal", "-shm", "-journal", ""}) {
    std::filesystem::remove(path.string() + suffix, error);
    if (error) {
      throw FileError(path, "cannot replace the earlier recording: " + error.message());
    }
  }
}

}  // namespace

void claim_recording_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status)) {
    remove_earlier_recording(path, status);
  }
  // SQLite would create the file too, but if that fails it opens it for reading and reports the failure of that.
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    throw FileError(path, std::string("cannot be created: ") + std::strerror(errno));
  }
  close(descriptor);
}

}  // namespace proleg::sim
