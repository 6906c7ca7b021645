#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace proleg::optimize {

/// What a list of searches shows of a store.
struct StoreSummary {
  std::string identity;       ///< another store has another one, also under the same name
  std::string method;         ///< its short name
  std::string scenario;       ///< path of its top-level file
  std::string started;        ///< Universal Time, "2026-11-27T23:40:00Z"; empty: not known
  std::uint64_t planned = 0;  ///< evaluations at most; 0: until the method ends
  std::uint64_t made = 0;     ///< evaluations of all runs
  std::uint32_t runs = 1;     ///< repetitions
  std::string objective;      ///< name of the first one
  std::string unit;           ///< of its score; empty: none
  bool maximises = true;
  /// The evaluation with the best score, of those that neither failed nor were given up.
  std::optional<std::uint64_t> best;
  double best_score = 0.0;
  std::optional<std::string> ending;  ///< why the last run ended; nothing: it did not
};

/// Reads that, and no more: the experiment's files may be of any kind. Another program may write the store. before:
/// what was read under this name before; if that is the same store, and it has one run, only the evaluations since are
/// looked at. Throws StoreError.
[[nodiscard]] StoreSummary read_store_summary(const std::filesystem::path& path, const StoreSummary* before = nullptr);

/// StoreSummary::identity. Throws StoreError.
[[nodiscard]] std::string identity_of_store(const std::filesystem::path& path);

}  // namespace proleg::optimize
