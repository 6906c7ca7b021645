#include "sim/optimize/evaluation/store.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <limits>
#include <map>
#include <utility>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/evaluation/store_schema.hpp"

namespace proleg::optimize {
namespace {

std::string text_of(const Candidate& candidate) {
  std::string text;
  std::array<char, 16> digits{};
  for (const std::uint32_t index : candidate) {
    text.append(text.empty() ? "" : " ");
    text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), index).ptr);
  }
  return text;
}

Candidate candidate_of(const std::string& text) {
  Candidate candidate;
  for (const std::string_view word : words(text)) {
    candidate.push_back(parse_whole<std::uint32_t>(word).value_or(0));
  }
  return candidate;
}

/// Binds values, or reads columns, one after the other.
class Row {
 public:
  explicit Row(Statement& statement) : statement_(statement) {}

  template <typename Value>
  void bind(const Value& value) {
    statement_.bind(++position_, value);
  }
  void bind(bool value) { statement_.bind(++position_, std::int64_t{value}); }
  void bind(std::span<const double> values) {
    for (const double value : values) {
      bind(value);
    }
  }

  void read(double& value) {
    const int column = position_++;
    value = statement_.is_null(column) ? std::numeric_limits<double>::quiet_NaN() : statement_.real(column);
  }
  void read(std::span<double> values) {
    for (double& value : values) {
      read(value);
    }
  }
  std::int64_t integer() { return statement_.integer(position_++); }
  std::string text() { return statement_.text(position_++); }
  void skip(std::size_t columns) { position_ += static_cast<int>(columns); }

 private:
  Statement& statement_;
  int position_ = 0;
};

/// What went wrong, as a person says it. system: errno after it.
std::string reason(const SqliteError& error, int system) {
  const bool refused = error.code() == SQLITE_IOERR && (system == ENOSPC || system == EDQUOT || system == EFBIG);
  if (error.code() == SQLITE_FULL || refused) {
    return "no room left on the disk; what was evaluated is kept";
  }
  if (error.code() == SQLITE_NOTADB) {
    return "is not the store of an experiment";
  }
  return error.what();
}

}  // namespace

class Store::Implementation {
 public:
  Implementation(const std::filesystem::path& path, const Experiment& experiment, const std::string& build_id,
                 Opening opening)
      : path_(path), experiment_(experiment), columns_(experiment) {
    guard([&] {
      lock_.emplace(opening == Opening::fresh ? create_store(path_, experiment_, columns_, build_id)
                                              : find_store(path_));
      database_ = std::make_unique<Database>(path, SQLITE_OPEN_READWRITE);
      if (opening == Opening::resume) {
        require_same_experiment(path, *database_, experiment, build_id);
      }
      // As for recordings: readers never disturb, a killed process leaves whole transactions.
      database_->execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE; ROLLBACK");
      statements_ = std::make_unique<Statements>(*database_, columns_);
      Statement last(*database_, "SELECT run, max(number) FROM trial GROUP BY run");
      while (last.step()) {
        last_numbers_[static_cast<std::uint32_t>(last.integer(0))] = static_cast<std::uint64_t>(last.integer(1));
      }
    });
  }

  std::optional<TrialResult> find(const Task& task) {
    // Most are asked for before they were ever made.
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
    guard([&] {
      const std::string candidate = text_of(task.candidate);
      const std::string seed_text = std::to_string(seed);
      Statement& statement = statements_->save_trial;
      statement.reset();
      Row row(statement);
      row.bind(task.run);
      row.bind(task.number);
      row.bind(task.trial);
      row.bind(std::string_view(seed_text));
      row.bind(std::string_view(candidate));
      row.bind(task.hopeless_below.value_or(std::numeric_limits<double>::quiet_NaN()));
      row.bind(std::span<const double>(result.measures.all()));
      row.bind(result.wall_s);
      row.bind(result.simulated_s);
      row.bind(worker);
      row.bind(result.given_up);
      row.bind(std::string_view(result.failure));
      statement.step();
      statement.reset();
    });
    std::uint64_t& last = last_numbers_[task.run];
    last = std::max(last, task.number);
  }

  void save(const Evaluation& evaluation) {
    guard([&] {
      const std::string candidate = text_of(evaluation.candidate);
      const std::string seed = std::to_string(trial_seed(experiment_.seed, evaluation.run, evaluation.number, 0));
      Statement& statement = statements_->save_evaluation;
      statement.reset();
      Row row(statement);
      row.bind(evaluation.run);
      row.bind(evaluation.number);
      row.bind(std::span<const double>(evaluation.scores));
      for (std::size_t i = 0; i < columns_.values.size(); ++i) {
        row.bind(experiment_.space.value(evaluation.candidate, i));
      }
      row.bind(std::span<const double>(evaluation.measures.all()));
      row.bind(std::string_view(seed));
      row.bind(evaluation.wall_s);
      row.bind(evaluation.simulated_s);
      row.bind(evaluation.given_up);
      row.bind(evaluation.reused);
      row.bind(std::string_view(evaluation.failure));
      row.bind(std::string_view(candidate));
      statement.step();
      statement.reset();
    });
  }

  void start_run(std::uint32_t run) {
    guard([&] { Statement(*database_, "DELETE FROM run WHERE run = ?1").run(run); });
  }

  void finish_run(std::uint32_t run, const std::string& ending) {
    guard([&] { Statement(*database_, "REPLACE INTO run VALUES(?1, ?2)").run(run, std::string_view(ending)); });
  }

  std::uint64_t evaluation_count(std::uint32_t run) {
    return guard([&] {
      Statement statement(*database_, "SELECT coalesce(max(number) + 1, 0) FROM evaluation WHERE run = ?1");
      statement.bind_all(run);
      return statement.step() ? static_cast<std::uint64_t>(statement.integer(0)) : 0;
    });
  }

  std::vector<Evaluation> evaluations(std::uint32_t run) {
    return guard([&] {
      std::vector<Evaluation> evaluations;
      Statement statement(*database_, "SELECT * FROM evaluation WHERE run = ?1 ORDER BY number");
      statement.bind_all(run);
      while (statement.step()) {
        evaluations.push_back(read_evaluation(statement));
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

  /// Does something with the file; every error comes out as StoreError.
  template <typename Action>
  std::invoke_result_t<Action> guard(const Action& action) {
    try {
      errno = 0;
      return action();
    } catch (const SqliteError& error) {
      const int system = errno;
      throw StoreError(path_.string() + ": " + reason(error, system));
    } catch (const std::filesystem::filesystem_error& error) {
      throw StoreError(path_.string() + ": " + error.code().message());
    }
  }

  static std::optional<TrialResult> read_trial(Statement& statement, const Task& task) {
    Row row(statement);
    row.skip(4);
    double hopeless_below = 0.0;
    const bool same_candidate = candidate_of(row.text()) == task.candidate;
    row.read(hopeless_below);
    // "Not a number", which is equal to nothing, stands for none.
    const bool same_limit =
        task.hopeless_below ? hopeless_below == *task.hopeless_below : hopeless_below != hopeless_below;
    if (!same_candidate || !same_limit) {
      return std::nullopt;
    }
    TrialResult result;
    row.read(result.measures.all());
    row.read(result.wall_s);
    row.read(result.simulated_s);
    row.skip(1);
    result.given_up = row.integer() != 0;
    result.failure = row.text();
    return result;
  }

  [[nodiscard]] Evaluation read_evaluation(Statement& statement) const {
    Evaluation evaluation;
    Row row(statement);
    evaluation.run = static_cast<std::uint32_t>(row.integer());
    evaluation.number = static_cast<std::uint64_t>(row.integer());
    evaluation.scores.resize(experiment_.objectives.size());
    row.read(evaluation.scores);
    row.skip(columns_.values.size());
    row.read(evaluation.measures.all());
    row.skip(1);
    row.read(evaluation.wall_s);
    row.read(evaluation.simulated_s);
    evaluation.given_up = row.integer() != 0;
    evaluation.reused = row.integer() != 0;
    evaluation.restored = !evaluation.reused;
    evaluation.failure = row.text();
    evaluation.candidate = candidate_of(row.text());
    return evaluation;
  }

  std::filesystem::path path_;
  const Experiment& experiment_;
  StoreColumns columns_;
  /// Outlives the database: closing any descriptor of a file takes the process's other locks on it along.
  std::optional<StoreLock> lock_;
  std::unique_ptr<Database> database_;
  std::unique_ptr<Statements> statements_;
  std::map<std::uint32_t, std::uint64_t> last_numbers_;  ///< highest number that has a trial, by run
};

Store::Store(const std::filesystem::path& path, const Experiment& experiment, const std::string& build_id,
             Opening opening)
    : implementation_(std::make_unique<Implementation>(path, experiment, build_id, opening)) {}
Store::~Store() = default;
std::optional<TrialResult> Store::find(const Task& task) { return implementation_->find(task); }
void Store::save(const Task& task, std::uint64_t seed, const TrialResult& result, std::uint32_t worker) {
  implementation_->save(task, seed, result, worker);
}
void Store::save(const Evaluation& evaluation) { implementation_->save(evaluation); }
void Store::start_run(std::uint32_t run) { implementation_->start_run(run); }
void Store::finish_run(std::uint32_t run, const std::string& reason) { implementation_->finish_run(run, reason); }
std::uint64_t Store::evaluation_count(std::uint32_t run) { return implementation_->evaluation_count(run); }
std::vector<Evaluation> Store::evaluations(std::uint32_t run) { return implementation_->evaluations(run); }
std::optional<std::string> Store::ending(std::uint32_t run) { return implementation_->ending(run); }

}  // namespace proleg::optimize
