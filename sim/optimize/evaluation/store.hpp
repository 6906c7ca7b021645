#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// Reads the description of a store's experiment, and nothing else. Throws StoreError.
[[nodiscard]] StoredExperiment read_stored_experiment(const std::filesystem::path& path);

/// The experiment of a store, from the files and options that the store keeps. Throws StoreError, and InputError for
/// files that this program does not read, for example because it lacks an algorithm.
[[nodiscard]] Experiment read_experiment_of(const std::filesystem::path& store);

/// Every trial and evaluation of an experiment in an SQLite file, each committed when it is known: a killed process
/// loses only the tasks that its workers had not finished. Other programs may read the file at the same time. `.schema`
/// in the sqlite3 shell explains the tables.
class Store {
 public:
  enum class Opening : std::uint8_t {
    fresh,   ///< the file must not exist
    resume,  ///< the file must exist, with the same experiment and result key
    look,    ///< the file must exist, and the experiment be that of read_experiment_of(); it is read only, and
             ///< another program may write it
    trust,   ///< as look, and the file must have the fingerprint of the experiment: its scores are used
  };
  /// Throws StoreError: the file does (not) exist, is no store, or is of another experiment or result
  /// key (tools/proleg/common/build_id.hpp).
  Store(const std::filesystem::path& path, const Experiment& experiment, const std::string& result_key,
        Opening opening);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  /// The result of exactly this task; nothing if the store does not have it.
  [[nodiscard]] std::optional<TrialResult> find(const Task& task);
  /// Saves the result of a worker. Replaces one of the same run, number and trial (a wrong prediction). Throws
  /// StoreError, for example if the disk is full; what was saved before stays.
  void save(const Task& task, std::uint64_t seed, const TrialResult& result, std::uint32_t worker);
  /// Saves what the optimiser used, in the order of number. Saving one again changes nothing.
  void save(const Evaluation& evaluation);
  /// Saves the number of evaluations of this search, for read_stored_experiment() and read_store_summary(), and the
  /// build of the program. trials: of each candidate, if an option gave them.
  void save_search(std::uint64_t evaluations, const std::string& build_id,
                   std::optional<std::uint32_t> trials = std::nullopt);
  /// Whether another program has asked this one to stop (request_stop()) since the store was opened. Looks at most five
  /// times a second, so it may be called often.
  [[nodiscard]] bool is_stop_requested();
  /// Marks a run as running: it has no ending.
  void start_run(std::uint32_t run);
  /// Saves why a run ended ("converged", "no credit left", ...).
  void finish_run(std::uint32_t run, const std::string& reason);

  /// Adds all that another store of the same experiment and result key has, or what it has of one run; its rows replace
  /// those of the same run and number. It is on the disk when this returns. Throws StoreError, also if another program
  /// writes to that store.
  void add(const std::filesystem::path& other, std::optional<std::uint32_t> run = {});

  /// Number of the last evaluation of a run that was saved, plus 1.
  [[nodiscard]] std::uint64_t evaluation_count(std::uint32_t run);
  /// The saved evaluations of a run from a number on, by number, at most `most`.
  [[nodiscard]] std::vector<Evaluation> evaluations(std::uint32_t run, std::uint64_t from = 0,
                                                    std::size_t most = 1'000'000'000);
  /// Why a run ended; nothing if it did not.
  [[nodiscard]] std::optional<std::string> ending(std::uint32_t run);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::optimize
