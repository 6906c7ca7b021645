#pragma once

// Creates, locks and checks the file of a store. All functions throw StoreError or SqliteError.

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"

namespace proleg {
class Database;
class SqliteError;
}  // namespace proleg

namespace proleg::optimize {

struct StoreColumns;

/// A store cannot be used. what() is one line: file, what was found, what was expected.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a store says of its search: enough to read the experiment again.
struct StoredExperiment {
  std::string path;      ///< of the experiment's file, as the search that made the store had it
  std::string scenario;  ///< path of its top-level file
  std::uint64_t seed = 0;
  std::uint64_t evaluations = 0;         ///< of the latest search; 0: until the method ends
  std::string engine;                    ///< trial_maker(), which may be another one than that of the files
  std::string simulated_robot;           ///< Experiment::simulated_robot
  std::optional<std::uint32_t> trials;   ///< of each candidate, if not the files said so
  std::vector<sim::SourceFile> sources;  ///< every file that was read
};

/// What StoreLock says of a store that another program writes to.
inline constexpr std::string_view another_writer = "another program is writing to it";

/// The lock of the one program that writes to a store. The system releases it when the process ends, in any way.
/// Readers do not need it. A sweep has such a lock, too, for its table. (SQLite's own locks exist only while it
/// writes.) The lock is on a file beside the store, which remains: on a network file system a lock on the store itself
/// would lock SQLite out. The file has the number of the process that was ready to write last.
class StoreLock {
 public:
  /// Throws StoreError if another program has the lock, or if its file cannot be made. The message then says `failure`.
  StoreLock(const std::filesystem::path& store, const std::string& failure);
  ~StoreLock();
  StoreLock(StoreLock&& other) noexcept;
  StoreLock& operator=(StoreLock&&) = delete;

  /// The store is open and can be written: writer_of() is this process.
  void note_writer() const;

 private:
  int descriptor_;
};

/// The time now, as the files of results have it: ISO 8601, in universal time.
[[nodiscard]] std::string universal_time();

/// Whether a program writes to the store now. False for a store on a file system without such locks.
[[nodiscard]] bool is_being_written(const std::filesystem::path& store);
/// The process that writes to the store now, by its number on the computer where it runs. Nothing, or the one before,
/// if there is none or it is not ready yet.
[[nodiscard]] std::optional<pid_t> writer_of(const std::filesystem::path& store);

/// Asks the program that writes to a store to stop, as Ctrl-C does, on whatever computer it runs: by a file beside the
/// store. Throws StoreError if no program writes to it, or if the file cannot be made.
void request_stop(const std::filesystem::path& store);
/// Whether a stop of the program that writes to the store was requested and has not been carried out.
[[nodiscard]] bool is_stop_requested(const std::filesystem::path& store);
/// What request_stop() asked for is done, or was for a program that has ended.
void forget_stop_request(const std::filesystem::path& store);

/// Makes a store with its tables and the description of the experiment. The path must not exist.
[[nodiscard]] StoreLock create_store(const std::filesystem::path& path, const Experiment& experiment,
                                     const StoreColumns& columns, const std::string& result_key);

/// Throws StoreError unless there is a file.
void require_store_file(const std::filesystem::path& path);

/// Reads what create_store() wrote. Throws StoreError unless it is a store of this format.
[[nodiscard]] StoredExperiment read_description(const std::filesystem::path& path, Database& database);

/// Locks an existing store for writing.
[[nodiscard]] StoreLock claim_store(const std::filesystem::path& path);

/// Throws StoreError unless it is a store of this format.
void require_store(const std::filesystem::path& path, Database& database);

/// A value of the table `experiment`; empty if there is none.
[[nodiscard]] std::string described_value(Database& database, std::string_view key);

/// What went wrong, as a message for a person. system: errno after the error.
[[nodiscard]] std::string reason_of(const SqliteError& error, int system);

/// Throws StoreError if the store of this format has another experiment.
void require_same_fingerprint(const std::filesystem::path& path, Database& database, const Experiment& experiment);

/// Throws StoreError unless it is a store of this format, experiment and result key.
void require_same_experiment(const std::filesystem::path& path, Database& database, const Experiment& experiment,
                             const std::string& result_key);

}  // namespace proleg::optimize
