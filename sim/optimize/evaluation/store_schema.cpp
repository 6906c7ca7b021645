#include "sim/optimize/evaluation/store_schema.hpp"

#include <algorithm>
#include <array>
#include <set>
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

std::string sql_name(std::string_view name) {
  std::string text = "\"";
  for (const char character : name) {
    text += character == '"' ? "\"\"" : std::string(1, character);
  }
  return text + "\"";
}

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

}  // namespace

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
  -- of fresh runs, which confirm the best; of a judged search they are in the judging engine, ODE. candidate: for each dimension the position of its
  -- value in the set of values, from 0. hopeless_below: the score that it had to be heading for. given_up: 1 if it was
  -- not; then distance is what it was heading for. failure: why it broke down, or ''.
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

}  // namespace proleg::optimize
