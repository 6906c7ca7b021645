#pragma once

// A small interface of SQLite: a connection, prepared statements, and errors as exceptions.

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include <sqlite3.h>

namespace proleg {

class SqliteError : public std::runtime_error {
 public:
  SqliteError(int code, const std::string& what) : std::runtime_error(what), code_(code) {}
  /// Primary result code, such as SQLITE_FULL.
  [[nodiscard]] int code() const { return code_ & 0xFF; }

 private:
  int code_;
};

/// A connection, for one thread. It waits up to 10 s for the lock of another program.
class Database {
 public:
  /// flags: SQLITE_OPEN_READONLY, or SQLITE_OPEN_READWRITE with or without SQLITE_OPEN_CREATE. What is opened for
  /// reading leaves the folder as it is: the file and its log do not change, and no file is created beside them.
  Database(const std::filesystem::path& path, int flags);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Runs statements whose results are not needed.
  void execute(const char* sql);

  /// For a file with a write-ahead log that this program writes for long: throws SqliteError if another program has
  /// removed, renamed, replaced, shortened or overwritten the file or its log since the last call. SQLite does not
  /// notice that: it writes into a file without a name, or into a damaged one. After the error nothing more is written:
  /// a file that was renamed is complete, a file that was changed stays as it is. Call it outside of transactions.
  void require_own_file();
  /// Takes what this program has written since as its own. require_own_file() does that, too.
  void note_own_file();

  [[nodiscard]] sqlite3* handle() const { return handle_; }
  [[noreturn]] void fail(int code) const;

 private:
  /// The file at the last note_own_file(); it does not become smaller by itself.
  struct File {
    sqlite3_int64 size = 0;  ///< 0: not known
    std::string identity;    ///< the parts of its head that never change
  };
  struct Log {
    sqlite3_int64 size = 0;
    std::uint64_t inode = 0;  ///< 0: not known
  };

  [[nodiscard]] bool is_overwritten() const;
  [[noreturn]] void fail_as_overwritten() const;

  sqlite3* handle_ = nullptr;
  File file_;
  Log log_;
};

/// A prepared statement. It must not outlive its connection.
class Statement {
 public:
  Statement(Database& database, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Runs the statement to its end with these values for ?1, ?2, ...
  template <typename... Values>
  void run(const Values&... values) {
    bind_all(values...);
    while (step()) {
    }
    reset();
  }

  /// Restarts the statement with these values; each call of step() then gives a row.
  template <typename... Values>
  void bind_all(const Values&... values) {
    reset();
    int position = 0;
    (bind(++position, values), ...);
  }
  /// Goes to the next row; false at the end.
  bool step();
  void reset();

  // Binds single values, for a statement whose number of values is known at run time only. Call reset() first.
  // Positions count from 1. Text must remain valid until the statement has run.
  void bind(int position, std::int64_t value);
  void bind(int position, std::int32_t value) { bind(position, std::int64_t{value}); }
  void bind(int position, std::uint32_t value) { bind(position, std::int64_t{value}); }
  void bind(int position, std::size_t value) { bind(position, static_cast<std::int64_t>(value)); }
  void bind(int position, double value);  ///< SQLite stores "not a number" as NULL
  void bind(int position, std::string_view value);

  // Values of the columns of the current row, which are counted from 0.
  [[nodiscard]] bool is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  [[nodiscard]] bool is_integer(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_INTEGER; }
  [[nodiscard]] bool is_real(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_FLOAT; }
  [[nodiscard]] std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  [[nodiscard]] double real(int column) const { return sqlite3_column_double(statement_, column); }
  [[nodiscard]] std::string text(int column) const;

 private:
  void check(int code) const;

  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace proleg
