#include "shared/computer/sqlite/sqlite.hpp"

#include <cstring>

namespace proleg {

Database::Database(const std::filesystem::path& path, int flags) {
  // SQLite interprets names like ":memory:" and "file:..."; an absolute path is always a file.
  const std::filesystem::path file = std::filesystem::absolute(path);
  const int code =
      sqlite3_open_v2(file.c_str(), &handle_, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, nullptr);
  if (code != SQLITE_OK) {
    try {
      fail(code);
    } catch (...) {
      sqlite3_close(handle_);  // the handle exists even after a failure, and has the message
      throw;
    }
  }
  sqlite3_busy_timeout(handle_, 2000);
}

Database::~Database() { sqlite3_close(handle_); }

void Database::execute(const char* sql) {
  if (const int code = sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr); code != SQLITE_OK) {
    fail(code);
  }
}

void Database::fail(int code) const {
  std::string what = handle_ != nullptr ? sqlite3_errmsg(handle_) : sqlite3_errstr(code);
  // "disk I/O error" and "unable to open database file" hide the reason that the system gave.
  const int primary = code & 0xFF;
  if (primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN) {
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
