#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// A store cannot be used; what() is one line: file, what was found, what was expected.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Every trial and evaluation of an experiment in an SQLite file, each committed when it is known: a killed process
/// loses what its workers were at, nothing else. Others may read the file at the same time. `.schema` in the sqlite3
/// shell explains the tables.
class Store {
 public:
  enum class Opening : std::uint8_t {
    fresh,   ///< the file must not be there
    resume,  ///< it must be there, of the same experiment and build
  };
  /// Throws StoreError: the file is (not) there, is something else, of another experiment or another build.
  Store(const std::filesystem::path& path, const Experiment& experiment, const std::string& build_id, Opening opening);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  /// The result of that very task, if it is here.
  [[nodiscard]] std::optional<TrialResult> find(const Task& task);
  /// What a worker found. One for the same run, number and trial is replaced (a prediction that did not come true).
  /// Throws StoreError, e.g. if the disk is full; what was saved before stays.
  void save(const Task& task, std::uint64_t seed, const TrialResult& result, std::uint32_t worker);
  /// What the optimiser used, in the order of number. One that is there is replaced by the same.
  void save(const Evaluation& evaluation);
  /// A run is under way (again): it has no ending.
  void start_run(std::uint32_t run);
  /// How a run ended ("converged", "credits used up", ...).
  void finish_run(std::uint32_t run, const std::string& reason);

  /// Number of the last evaluation of a run that was saved, plus 1.
  [[nodiscard]] std::uint64_t evaluation_count(std::uint32_t run);
  /// All evaluations of a run that were saved, by number. For pictures and tables.
  [[nodiscard]] std::vector<Evaluation> evaluations(std::uint32_t run);
  /// Why a run ended, if it did.
  [[nodiscard]] std::optional<std::string> ending(std::uint32_t run);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::optimize
