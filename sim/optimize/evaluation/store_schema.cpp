#include "sim/optimize/evaluation/store_schema.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "shared/computer/text/text.hpp"
#include "sim/measure/measure.hpp"

namespace proleg::optimize {
namespace {

/// SQLite's tables have at most 2000 columns. With more dimensions than this, values have no columns.
constexpr std::size_t max_value_columns = 1000;

constexpr std::array before_scores{"run", "number"};
constexpr std::array after_measures{"seed", "wall_s", "simulated_s", "given_up", "reused", "failure", "candidate"};

constexpr const char* fixed_tables = R"sql(
CREATE TABLE experiment(
  -- What the store is of. fingerprint: of everything that determines the results. started: Universal Time.
  key TEXT PRIMARY KEY,
  value TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE part(
  -- The experiment as the program understood it.
  name TEXT PRIMARY KEY,
  text TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE source(
  -- Every file that was read, the experiment's own first.
  position INTEGER PRIMARY KEY,
  path TEXT NOT NULL,
  text TEXT NOT NULL
) STRICT;

CREATE TABLE objective(
  -- What candidates are rated by. goal: maximise or minimise. terms: weight * measure + ... failed: the score of a run
  -- that has none.
  position INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  column_name TEXT NOT NULL,
  goal TEXT NOT NULL,
  terms TEXT NOT NULL,
  failed REAL NOT NULL
) STRICT;

CREATE TABLE dimension(
  -- What is searched for. value_count: size of the set of values, from lowest to highest, in unit.
  position INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  column_name TEXT,
  unit TEXT NOT NULL,
  value_count INTEGER NOT NULL,
  lowest REAL NOT NULL,
  highest REAL NOT NULL
) STRICT;

CREATE TABLE measure(
  -- What the columns of trial and evaluation mean that are named so. NULL: the run does not define it.
  name TEXT PRIMARY KEY,
  unit TEXT NOT NULL,
  help TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE run(
  -- Repetitions of the experiment that have ended, and why.
  run INTEGER PRIMARY KEY,
  ending TEXT NOT NULL
) STRICT;
)sql";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : ", ") + sql_name(word);
  }
  return text;
}

std::string real_columns(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += "  " + sql_name(name) + " REAL,\n";
  }
  return text;
}

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
    candidate.push_back(parse_whole<std::uint32_t>(word).value_or(std::numeric_limits<std::uint32_t>::max()));
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

}  // namespace

std::string sql_name(std::string_view name) {
  std::string text = "\"";
  for (const char character : name) {
    text += character == '"' ? "\"\"" : std::string(1, character);
  }
  return text + "\"";
}

StoreColumns::StoreColumns(const Experiment& experiment) {
  std::set<std::string> taken(before_scores.begin(), before_scores.end());
  taken.insert(after_measures.begin(), after_measures.end());
  const auto own = [&taken](std::string name) {
    while (!taken.insert(lower_case(name)).second) {
      name += "_";
    }
    return name;
  };
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    measures.push_back(own(std::string(measure.name)));
  }
  for (const Objective& objective : experiment.objectives) {
    scores.push_back(own("score " + objective.name));
  }
  if (experiment.space.dimensions.size() <= max_value_columns) {
    for (const Dimension& dimension : experiment.space.dimensions) {
      values.push_back(own(dimension.name));
    }
  }
}

std::vector<std::string> trial_columns(const StoreColumns& columns) {
  std::vector<std::string> names{"run", "number", "trial", "seed", "candidate", "hopeless_below"};
  names.insert(names.end(), columns.measures.begin(), columns.measures.end());
  for (const char* name : {"wall_s", "simulated_s", "worker", "given_up", "failure"}) {
    names.emplace_back(name);
  }
  return names;
}

std::vector<std::string> evaluation_columns(const StoreColumns& columns) {
  std::vector<std::string> names(before_scores.begin(), before_scores.end());
  for (const auto* group : {&columns.scores, &columns.values, &columns.measures}) {
    names.insert(names.end(), group->begin(), group->end());
  }
  names.insert(names.end(), after_measures.begin(), after_measures.end());
  return names;
}

std::string store_schema(const Experiment& experiment, const StoreColumns& columns) {
  std::string sql = fixed_tables;
  sql += R"sql(
CREATE TABLE trial(
  -- Every simulation, also some that were made ahead and not used. trial: from 0; numbers that no evaluation uses are
  -- of fresh runs, which confirm the best; of a judged search they are in the judging engine, ODE. candidate: for each
  -- dimension the position of its value in the set of values, from 0. hopeless_below: the score that it had to be
  -- heading for. given_up: 1 if it was not; then distance is what it was heading for. failure: why it broke down, or ''.
  run INTEGER NOT NULL,
  number INTEGER NOT NULL,
  trial INTEGER NOT NULL,
  seed TEXT NOT NULL,
  candidate TEXT NOT NULL,
  hopeless_below REAL,
)sql";
  sql += real_columns(columns.measures);
  sql += R"sql(  wall_s REAL NOT NULL,
  simulated_s REAL NOT NULL,
  worker INTEGER NOT NULL,
  given_up INTEGER NOT NULL,
  failure TEXT NOT NULL,
  PRIMARY KEY(run, number, trial)
) STRICT, WITHOUT ROWID;

CREATE TABLE evaluation(
  -- What the search used, in the order of number: scores, values in the unit that the table dimension says, measures
  -- (mean over the trials that did not fail). seed: of trial 0. reused: 1 if it was known from an earlier one and not
  -- simulated.
  run INTEGER NOT NULL,
  number INTEGER NOT NULL,
)sql";
  for (const auto* group : {&columns.scores, &columns.values, &columns.measures}) {
    sql += real_columns(*group);
  }
  sql += R"sql(  seed TEXT NOT NULL,
  wall_s REAL NOT NULL,
  simulated_s REAL NOT NULL,
  given_up INTEGER NOT NULL,
  reused INTEGER NOT NULL,
  failure TEXT NOT NULL,
  candidate TEXT NOT NULL,
  PRIMARY KEY(run, number)
) STRICT, WITHOUT ROWID;
)sql";
  const bool maximise = experiment.objectives.front().goal == Goal::maximise;
  sql +=
      "\nCREATE VIEW best AS\n  -- The ten best evaluations by the first objective.\n  SELECT * FROM evaluation ORDER "
      "BY " +
      sql_name(columns.scores.front()) + (maximise ? " DESC" : " ASC") + ", run, number LIMIT 10;\n";
  return sql;
}

std::string replace_row(const std::string& table, const std::vector<std::string>& columns) {
  std::string places;
  for (std::size_t i = 1; i <= columns.size(); ++i) {
    places += (i == 1 ? "?" : ", ?") + std::to_string(i);
  }
  return "REPLACE INTO " + table + "(" + joined(columns) + ") VALUES(" + places + ")";
}

void save_trial_row(Statement& statement, const Task& task, std::uint64_t seed, const TrialResult& result,
                    std::uint32_t worker) {
  const std::string candidate = text_of(task.candidate);
  const std::string seed_text = std::to_string(seed);
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
}

std::optional<TrialResult> read_trial(Statement& statement, const Task& task) {
  Row row(statement);
  row.skip(4);
  double hopeless_below = 0.0;
  const bool same_candidate = candidate_of(row.text()) == task.candidate;
  row.read(hopeless_below);
  // The store holds NaN, which equals no number, for "no limit".
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

void save_evaluation_row(Statement& statement, const Experiment& experiment, const StoreColumns& columns,
                         const Evaluation& evaluation) {
  const std::string candidate = text_of(evaluation.candidate);
  const std::string seed =
      std::to_string(seed_of(experiment, {evaluation.run, evaluation.number, 0, evaluation.candidate, {}}));
  statement.reset();
  Row row(statement);
  row.bind(evaluation.run);
  row.bind(evaluation.number);
  row.bind(std::span<const double>(evaluation.scores));
  for (std::size_t i = 0; i < columns.values.size(); ++i) {
    row.bind(experiment.space.value(evaluation.candidate, i));
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
}

Evaluation read_evaluation(Statement& statement, const Experiment& experiment, const StoreColumns& columns) {
  Evaluation evaluation;
  Row row(statement);
  evaluation.run = static_cast<std::uint32_t>(row.integer());
  evaluation.number = static_cast<std::uint64_t>(row.integer());
  evaluation.scores.resize(experiment.objectives.size());
  row.read(evaluation.scores);
  row.skip(columns.values.size());
  row.read(evaluation.measures.all());
  row.skip(1);
  row.read(evaluation.wall_s);
  row.read(evaluation.simulated_s);
  evaluation.given_up = row.integer() != 0;
  evaluation.reused = row.integer() != 0;
  evaluation.restored = !evaluation.reused;
  evaluation.failure = row.text();
  evaluation.candidate = candidate_of(row.text());
  const std::vector<Dimension>& dimensions = experiment.space.dimensions;
  bool is_in_space = evaluation.candidate.size() == dimensions.size();
  for (std::size_t i = 0; is_in_space && i < dimensions.size(); ++i) {
    is_in_space = evaluation.candidate[i] < dimensions[i].values.size();
  }
  if (!is_in_space) {
    throw SqliteError(SQLITE_CORRUPT, "the candidate of evaluation " + std::to_string(evaluation.number) +
                                          " is not in the search space; another program has changed the store");
  }
  return evaluation;
}

}  // namespace proleg::optimize
