#include "shared/computer/sqlite/sqlite.hpp"

#include <sys/stat.h>

#include <array>
#include <cstring>
#include <fstream>
#include <system_error>

namespace proleg {
namespace {

constexpr int max_wait_ms = 10'000;

/// A file of a connection, through SQLite: closing a descriptor of our own would release SQLite's locks.
class OpenFile {
 public:
  /// operation: SQLITE_FCNTL_FILE_POINTER or, for the log, SQLITE_FCNTL_JOURNAL_POINTER.
  OpenFile(sqlite3* connection, int operation) { sqlite3_file_control(connection, "main", operation, &file_); }

  [[nodiscard]] bool is_open() const { return file_ != nullptr && file_->pMethods != nullptr; }
  /// Whether its name is that of another file, or of none.
  [[nodiscard]] bool has_moved() const {
    int moved = 0;
    return file_->pMethods->xFileControl(file_, SQLITE_FCNTL_HAS_MOVED, &moved) == SQLITE_OK && moved != 0;
  }
  [[nodiscard]] sqlite3_int64 size() const {
    sqlite3_int64 size = 0;
    return file_->pMethods->xFileSize(file_, &size) == SQLITE_OK ? size : 0;
  }
  /// Of a database file (https://www.sqlite.org/fileformat.html): magic string, page size, schema cookie, version and
  /// kind. The cookie tells files of one schema from each other if their programs have drawn it at random.
  [[nodiscard]] std::string identity() const {
    std::array<char, 100> head{};
    file_->pMethods->xRead(file_, head.data(), static_cast<int>(head.size()), 0);  // zeros if it is shorter
    return std::string(head.data(), 18) + std::string(head.data() + 40, 4) + std::string(head.data() + 60, 12);
  }

 private:
  sqlite3_file* file_ = nullptr;
};

/// The number of the log that has its name now; 0: there is none. (SQLite itself knows this of the main file only.)
std::uint64_t inode_of_log(sqlite3* connection) {
  struct stat status {};
  const char* const name = sqlite3_filename_wal(sqlite3_db_filename(connection, "main"));
  return name != nullptr && stat(name, &status) == 0 ? status.st_ino : 0;
}

/// Whether a log that became smaller lacks frames that SQLite counts. (A program may empty it in SQLite's way.)
bool lacks_frames(sqlite3* connection, const OpenFile& log) {
  int frames = 0;
  const int code = sqlite3_wal_checkpoint_v2(connection, "main", SQLITE_CHECKPOINT_PASSIVE, &frames, nullptr);
  constexpr sqlite3_int64 min_frame = 24 + 512;  // its head and the smallest page
  return (code != SQLITE_OK && code != SQLITE_BUSY) || log.size() < frames * min_frame;
}

bool has_write_ahead_log(const std::filesystem::path& file) {
  std::array<char, 20> head{};
  std::ifstream(file, std::ios::binary).read(head.data(), head.size());
  return head[18] == 2 || head[19] == 2;  // the versions for writing and reading (fileformat.html 1.3.3)
}

/// How a file is read.
enum class Reading : std::uint8_t {
  shared,     ///< with the locks and the index of the log that a program which writes the file has made
  immutable,  ///< without locks and without a log
  alone,      ///< without locks, with a log and with an index of it in memory
};

/// The way that leaves the folder as it is. SQLite by itself creates the index of a log, and a log if there is none.
Reading way_of_reading(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code error;
  if (!has_write_ahead_log(file)) {
    return Reading::shared;
  }
  const auto log_size = std::filesystem::file_size(name + "-wal", error);
  if (error) {
    return Reading::immutable;  // a program that writes has a log
  }
  if (std::filesystem::exists(name + "-shm", error)) {
    return Reading::shared;
  }
  return log_size == 0 ? Reading::immutable : Reading::alone;
}

/// https://www.sqlite.org/uri.html
std::string uri_of(const std::filesystem::path& file) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char c : file.string()) {
    if (c == '%' || c == '?' || c == '#') {
      const auto byte = static_cast<unsigned char>(c);
      uri += {'%', digits[byte / 16U], digits[byte % 16U]};
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

}  // namespace

Database::Database(const std::filesystem::path& path, int flags) {
  // SQLite interprets names like ":memory:" and "file:..."; an absolute path is always a file.
  const std::filesystem::path file = std::filesystem::absolute(path);
  const Reading reading = (flags & SQLITE_OPEN_READONLY) != 0 ? way_of_reading(file) : Reading::shared;
  const bool is_immutable = reading == Reading::immutable;
  const int code =
      sqlite3_open_v2(is_immutable ? uri_of(file).c_str() : file.c_str(), &handle_,
                      flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE | (is_immutable ? SQLITE_OPEN_URI : 0),
                      reading == Reading::alone ? "unix-none" : nullptr);
  if (code != SQLITE_OK) {
    try {
      fail(code);
    } catch (...) {
      sqlite3_close(handle_);  // the handle exists even after a failure, and has the message
      throw;
    }
  }
  sqlite3_busy_timeout(handle_, max_wait_ms);
  if (reading == Reading::alone) {
    execute("PRAGMA locking_mode = EXCLUSIVE");  // with it the index of the log is in memory
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  }
}

Database::~Database() { sqlite3_close(handle_); }

void Database::execute(const char* sql) {
  if (const int code = sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr); code != SQLITE_OK) {
    fail(code);
  }
}

void Database::require_own_file() {
  const OpenFile log(handle_, SQLITE_FCNTL_JOURNAL_POINTER);
  const bool has_lost_log = log_.size > 0 && log.is_open() && log.size() < log_.size && lacks_frames(handle_, log);
  if (has_lost_log || is_overwritten()) {
    fail_as_overwritten();
  }
  const bool has_moved = OpenFile(handle_, SQLITE_FCNTL_FILE_POINTER).has_moved() ||
                         (log_.inode != 0 && inode_of_log(handle_) != log_.inode);
  if (has_moved) {
    sqlite3_wal_checkpoint_v2(handle_, "main", SQLITE_CHECKPOINT_TRUNCATE, nullptr, nullptr);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    throw SqliteError(
        SQLITE_READONLY_DBMOVED,
        "another program removed, renamed or replaced the file or its log while this program wrote it; "
        "expected that the file keeps its name; if it was renamed, rename it back: it has all data until now");
  }
  note_own_file();
}

void Database::note_own_file() {
  const OpenFile file(handle_, SQLITE_FCNTL_FILE_POINTER);
  const OpenFile log(handle_, SQLITE_FCNTL_JOURNAL_POINTER);
  file_ = {file.size(), file.identity()};
  log_ = log.is_open() ? Log{log.size(), inode_of_log(handle_)} : Log{};
}

bool Database::is_overwritten() const {
  if (file_.size == 0) {
    return false;
  }
  const OpenFile file(handle_, SQLITE_FCNTL_FILE_POINTER);
  return file.size() < file_.size || file.identity() != file_.identity;
}

void Database::fail_as_overwritten() const {
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  throw SqliteError(SQLITE_CORRUPT,
                    "another program shortened or overwrote the file or its log while this program wrote it; "
                    "expected that no other program writes there");
}

void Database::fail(int code) const {
  std::string what = handle_ != nullptr ? sqlite3_errmsg(handle_) : sqlite3_errstr(code);
  // "disk I/O error" and "unable to open database file" hide the reason that the system gave.
  const int primary = code & 0xFF;
  if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB) {
    if (is_overwritten()) {
      fail_as_overwritten();
    }
  } else if (primary == SQLITE_BUSY) {
    what = "another program keeps it locked for more than " + std::to_string(max_wait_ms / 1000) +
           " s; expected that it writes for a shorter time; end that program";
  } else if (primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN) {
    if (const int reason = handle_ != nullptr ? sqlite3_system_errno(handle_) : 0; reason != 0) {
      what += std::string(": ") + std::strerror(reason);
    }
  }
  throw SqliteError(code, what);
}

Statement::Statement(Database& database, std::string_view sql) : database_(database) {
  const int code = sqlite3_prepare_v3(database.handle(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &statement_, nullptr);
  check(code);
}

Statement::~Statement() { sqlite3_finalize(statement_); }

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) {
    return true;
  }
  if (code != SQLITE_DONE) {
    check(code);
  }
  return false;
}

// The result is not checked: it repeats the error of the last step, which was reported there.
void Statement::reset() { sqlite3_reset(statement_); }

std::string Statement::text(int column) const {
  const void* bytes = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  return bytes == nullptr ? std::string()
                          : std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

void Statement::bind(int position, std::int64_t value) { check(sqlite3_bind_int64(statement_, position, value)); }

void Statement::bind(int position, double value) { check(sqlite3_bind_double(statement_, position, value)); }

// SQLite takes no copy if it is given no destructor. The text outlives the run() or the row loop that binds it.
void Statement::bind(int position, std::string_view value) {
  check(sqlite3_bind_text64(statement_, position, value.data(), value.size(), nullptr, SQLITE_UTF8));
}

void Statement::check(int code) const {
  if (code != SQLITE_OK) {
    database_.fail(code);
  }
}

}  // namespace proleg
