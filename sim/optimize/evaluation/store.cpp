#include "sim/optimize/evaluation/store.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <limits>
#include <map>
#include <utility>

#include "shared/computer/sqlite/sqlite.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/evaluation/store_schema.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::optimize {
class Store::Implementation {
 public:
  Implementation(const std::filesystem::path& path, const Experiment& experiment, const std::string& result_key,
                 Opening opening)
      : path_(path), experiment_(experiment), result_key_(result_key), columns_(experiment) {
    guard([&] {
      if (opening == Opening::look || opening == Opening::trust) {
        look();
        if (opening == Opening::trust) {
          require_same_fingerprint(path, *database_, experiment);
        }
        return;
      }
      lock_.emplace(opening == Opening::fresh ? create_store(path_, experiment_, columns_, result_key)
                                              : claim_store(path_));
      forget_stop_request(path_);  // of an earlier program: request_stop() needs the lock
      database_ = std::make_unique<Database>(path, SQLITE_OPEN_READWRITE);
      if (opening == Opening::resume) {
        require_same_experiment(path, *database_, experiment, result_key);
      }
      // The journal is that of recordings: readers never block the writer, and a killed process leaves whole
      // transactions.
      database_->execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE; ROLLBACK");
      database_->require_own_file();
      statements_ = std::make_unique<Statements>(*database_, columns_);
      read_last_numbers();
      lock_->note_writer();
    });
  }
  ~Implementation() {
    if (lock_) {
      forget_stop_request(path_);
    }
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  bool is_stop_requested() {
    constexpr std::chrono::milliseconds period{200};
    if (const auto now = std::chrono::steady_clock::now(); !is_stop_requested_ && now >= next_look_) {
      is_stop_requested_ = optimize::is_stop_requested(path_);
      next_look_ = now + period;
    }
    return is_stop_requested_;
  }

  std::optional<TrialResult> find(const Task& task) {
    // Most tasks are looked up before they are simulated for the first time.
    const auto last = last_numbers_.find(task.run);
    if (last == last_numbers_.end() || task.number > last->second) {
      return std::nullopt;
    }
    return guard([&]() -> std::optional<TrialResult> {
      Statement& statement = statements_->find_trial;
      statement.bind_all(task.run, task.number, task.trial);
      std::optional<TrialResult> found;
      if (statement.step()) {
        found = read_trial(statement, task);
      }
      statement.reset();
      return found;
    });
  }

  void save(const Task& task, std::uint64_t seed, const TrialResult& result, std::uint32_t worker) {
    write([&] { save_trial_row(statements_->save_trial, task, seed, result, worker); });
    std::uint64_t& last = last_numbers_[task.run];
    last = std::max(last, task.number);
  }

  void save(const Evaluation& evaluation) {
    write([&] { save_evaluation_row(statements_->save_evaluation, experiment_, columns_, evaluation); });
  }

  void save_search(std::uint64_t evaluations, const std::string& build_id, std::optional<std::uint32_t> trials) {
    const std::string text = std::to_string(evaluations);
    Experiment search = experiment_;
    search.evaluations = evaluations;
    const std::string planned = std::to_string(planned_evaluations(search));
    write([&] {
      Statement entry(*database_, "REPLACE INTO experiment VALUES(?1, ?2)");
      entry.run(std::string_view("evaluations"), std::string_view(text));
      entry.run(std::string_view("planned"), std::string_view(planned));
      entry.run(std::string_view("build_id"), std::string_view(build_id));
      if (trials) {
        const std::string count = std::to_string(*trials);
        entry.run(std::string_view("trials"), std::string_view(count));
      }
    });
  }

  void start_run(std::uint32_t run) {
    write([&] { Statement(*database_, "DELETE FROM run WHERE run = ?1").run(run); });
  }

  void finish_run(std::uint32_t run, const std::string& ending) {
    write([&] { Statement(*database_, "REPLACE INTO run VALUES(?1, ?2)").run(run, std::string_view(ending)); });
  }

  void add(const std::filesystem::path& other, std::optional<std::uint32_t> run) {
    write([&] {
      const StoreLock lock = claim_store(other);
      {
        Database its(other, SQLITE_OPEN_READWRITE);
        require_same_experiment(other, its, experiment_, result_key_);
      }
      const std::string path = other.string();
      Statement(*database_, "ATTACH DATABASE ?1 AS other").run(std::string_view(path));
      const std::string which = run ? " WHERE run = " + std::to_string(*run) : "";
      // The caller may delete the other store then: this one must have reached the disk, which NORMAL does not wait
      // for.
      std::string statements = "PRAGMA synchronous = FULL; BEGIN;";
      for (const char* table : {"trial", "evaluation", "run"}) {
        statements += std::string(" REPLACE INTO ") + table + " SELECT * FROM other." + table + which + ";";
      }
      database_->execute((statements + " COMMIT; DETACH DATABASE other; PRAGMA synchronous = NORMAL").c_str());
      read_last_numbers();
    });
  }

  std::uint64_t evaluation_count(std::uint32_t run) {
    return guard([&] {
      Statement statement(*database_, "SELECT coalesce(max(number) + 1, 0) FROM evaluation WHERE run = ?1");
      statement.bind_all(run);
      return statement.step() ? static_cast<std::uint64_t>(statement.integer(0)) : 0;
    });
  }

  std::vector<Evaluation> evaluations(std::uint32_t run, std::uint64_t from, std::size_t most) {
    return guard([&] {
      std::vector<Evaluation> evaluations;
      if (from > std::uint64_t{std::numeric_limits<std::int64_t>::max()}) {
        return evaluations;  // SQLite has no such numbers
      }
      Statement statement(*database_,
                          "SELECT * FROM evaluation WHERE run = ?1 AND number >= ?2 ORDER BY number LIMIT ?3");
      statement.bind_all(run, from, most);
      while (statement.step()) {
        evaluations.push_back(read_evaluation(statement, experiment_, columns_));
      }
      return evaluations;
    });
  }

  std::optional<std::string> ending(std::uint32_t run) {
    return guard([&] {
      Statement statement(*database_, "SELECT ending FROM run WHERE run = ?1");
      statement.bind_all(run);
      return statement.step() ? std::optional(statement.text(0)) : std::nullopt;
    });
  }

 private:
  struct Statements {
    Statements(Database& database, const StoreColumns& columns)
        : find_trial(database, "SELECT * FROM trial WHERE run = ?1 AND number = ?2 AND trial = ?3"),
          save_trial(database, replace_row("trial", trial_columns(columns))),
          save_evaluation(database, replace_row("evaluation", evaluation_columns(columns))) {}
    Statement find_trial;
    Statement save_trial;
    Statement save_evaluation;
  };

  void look() {
    require_store_file(path_);
    database_ = std::make_unique<Database>(path_, SQLITE_OPEN_READONLY);
    require_store(path_, *database_);
    statements_ = std::make_unique<Statements>(*database_, columns_);
  }

  void read_last_numbers() {
    Statement last(*database_, "SELECT run, max(number) FROM trial GROUP BY run");
    while (last.step()) {
      last_numbers_[static_cast<std::uint32_t>(last.integer(0))] = static_cast<std::uint64_t>(last.integer(1));
    }
  }

  /// Runs an action on the file and turns its errors into StoreError.
  template <typename Action>
  std::invoke_result_t<Action> guard(const Action& action) {
    try {
      errno = 0;
      return action();
    } catch (const SqliteError& error) {
      const int system = errno;
      throw StoreError(path_.string() + ": " + reason_of(error, system));
    } catch (const std::filesystem::filesystem_error& error) {
      throw StoreError(path_.string() + ": " + error.code().message());
    }
  }

  /// An action that writes.
  template <typename Action>
  void write(const Action& action) {
    guard([&] {
      database_->require_own_file();
      action();
      database_->note_own_file();
    });
  }

  std::filesystem::path path_;
  const Experiment& experiment_;
  std::string result_key_;
  StoreColumns columns_;
  /// Outlives the database: closing any descriptor of a file releases all locks of the process on it.
  std::optional<StoreLock> lock_;
  std::unique_ptr<Database> database_;
  std::unique_ptr<Statements> statements_;
  std::map<std::uint32_t, std::uint64_t> last_numbers_;  ///< largest number that has a trial, by run
  bool is_stop_requested_ = false;
  std::chrono::steady_clock::time_point next_look_;
};

void Store::save_search(std::uint64_t evaluations, const std::string& build_id, std::optional<std::uint32_t> trials) {
  implementation_->save_search(evaluations, build_id, trials);
}

StoredExperiment read_stored_experiment(const std::filesystem::path& path) {
  try {
    require_store_file(path);
    Database database(path, SQLITE_OPEN_READONLY);
    return read_description(path, database);
  } catch (const SqliteError& error) {
    throw StoreError(path.string() + ": " + reason_of(error, 0));
  }
}

Experiment read_experiment_of(const std::filesystem::path& store) {
  const StoredExperiment stored = read_stored_experiment(store);
  sim::SourceTexts files;
  for (const sim::SourceFile& source : stored.sources) {
    files.add(source.path, source.text);
  }
  Experiment experiment = read_experiment(stored.path, files, stored.scenario);
  experiment.seed = stored.seed;
  experiment.evaluations = stored.evaluations;
  if (stored.engine == robot_name) {
    put_on_robot(experiment, stored.simulated_robot);
  } else if (sim::name_of(experiment.scenario.environment.engine) != stored.engine) {
    sim::OverrideWords words;
    words.engine = stored.engine;
    experiment.scenario.overrides = sim::read_overrides(words);
    sim::apply_overrides(experiment.scenario.overrides, experiment.scenario.environment);
  }
  if (stored.trials) {
    set_trials(experiment, *stored.trials);
  }
  return experiment;
}

Store::Store(const std::filesystem::path& path, const Experiment& experiment, const std::string& result_key,
             Opening opening)
    : implementation_(std::make_unique<Implementation>(path, experiment, result_key, opening)) {}
Store::~Store() = default;
std::optional<TrialResult> Store::find(const Task& task) { return implementation_->find(task); }
void Store::save(const Task& task, std::uint64_t seed, const TrialResult& result, std::uint32_t worker) {
  implementation_->save(task, seed, result, worker);
}
void Store::save(const Evaluation& evaluation) { implementation_->save(evaluation); }
bool Store::is_stop_requested() { return implementation_->is_stop_requested(); }
void Store::start_run(std::uint32_t run) { implementation_->start_run(run); }
void Store::finish_run(std::uint32_t run, const std::string& reason) { implementation_->finish_run(run, reason); }
void Store::add(const std::filesystem::path& other, std::optional<std::uint32_t> run) {
  implementation_->add(other, run);
}
std::uint64_t Store::evaluation_count(std::uint32_t run) { return implementation_->evaluation_count(run); }
std::vector<Evaluation> Store::evaluations(std::uint32_t run, std::uint64_t from, std::size_t most) {
  return implementation_->evaluations(run, from, most);
}
std::optional<std::string> Store::ending(std::uint32_t run) { return implementation_->ending(run); }

}  // namespace proleg::optimize
