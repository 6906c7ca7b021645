#pragma once

// How a store's file comes to be, is claimed and is recognised. All throw StoreError, or SqliteError.

#include <filesystem>
#include <string>

#include "shared/computer/sqlite/sqlite.hpp"
#include "sim/optimize/evaluation/store_schema.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// The lock that says "a program writes into this store": it goes with the process, however that ends. Readers do not
/// care. (SQLite's own locks are held only while it writes.) It is on an empty file beside the store, which stays: on a
/// network file system one on the store itself would shut SQLite out.
class StoreLock {
 public:
  /// Throws StoreError if another has the lock, or its file cannot be made: then `refusal` says what cannot be done.
  StoreLock(const std::filesystem::path& store, const std::string& refusal);
  ~StoreLock();
  StoreLock(StoreLock&& other) noexcept;
  StoreLock& operator=(StoreLock&&) = delete;

 private:
  int descriptor_;
};

/// Makes a store with its tables and what it says about the experiment. There must be nothing under its name.
[[nodiscard]] StoreLock create_store(const std::filesystem::path& path, const Experiment& experiment,
                                     const StoreColumns& columns, const std::string& build_id);

/// Claims a file that is there.
[[nodiscard]] StoreLock find_store(const std::filesystem::path& path);

/// Refuses what is no store of this format, experiment and build.
void require_same_experiment(const std::filesystem::path& path, Database& database, const Experiment& experiment,
                             const std::string& build_id);

}  // namespace proleg::optimize
