#include "sim/optimize/evaluation/store_summary.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/evaluation/store_schema.hpp"

namespace proleg::optimize {
namespace {

/// What the experiment is, and the number that create_store() has drawn.
std::string identity_in(Database& database) {
  Statement version(database, "PRAGMA schema_version");
  return described_value(database, "fingerprint") + "/" + (version.step() ? std::to_string(version.integer(0)) : "");
}

void read_description_into(StoreSummary& summary, Database& database) {
  summary.identity = identity_in(database);
  summary.method = described_value(database, "method");
  summary.scenario = described_value(database, "scenario");
  summary.started = described_value(database, "started");
  const std::string planned = described_value(database, "planned");  // stores of earlier programs do not have it
  summary.planned =
      parse_whole<std::uint64_t>(planned.empty() ? described_value(database, "evaluations") : planned).value_or(0);
}

/// Returns the column of its score.
std::string read_objective_into(StoreSummary& summary, Database& database, const std::filesystem::path& path) {
  Statement objective(database, "SELECT name, column_name, goal, terms FROM objective ORDER BY position LIMIT 1");
  if (!objective.step()) {
    throw StoreError(path.string() + ": has no objective");
  }
  summary.objective = objective.text(0);
  summary.maximises = objective.text(2) == "maximise";
  Statement unit(database, "SELECT unit FROM measure WHERE name = ?1");
  constexpr std::string_view once = "1 * ";  // terms_text() of a single measure
  const std::string terms = objective.text(3);
  const std::string_view measure = terms.starts_with(once) ? std::string_view(terms).substr(once.size()) : "";
  unit.bind_all(measure);
  summary.unit = unit.step() ? unit.text(0) : std::string();
  return objective.text(1);
}

/// Returns the number of the last run.
std::int64_t count_evaluations_into(StoreSummary& summary, Database& database) {
  constexpr std::uint32_t most_runs = 10'000;
  std::int64_t last = -1;
  Statement next(database, "SELECT min(run) FROM evaluation WHERE run > ?1");
  Statement count(database, "SELECT coalesce(max(number) + 1, 0) FROM evaluation WHERE run = ?1");
  for (summary.runs = 0; summary.runs < most_runs; ++summary.runs) {
    next.bind_all(last);
    if (!next.step() || next.is_null(0)) {
      break;
    }
    last = next.integer(0);
    count.bind_all(last);
    summary.made += count.step() ? static_cast<std::uint64_t>(std::max<std::int64_t>(count.integer(0), 0)) : 0;
  }
  summary.runs = std::max(summary.runs, 1U);
  return std::max<std::int64_t>(last, 0);
}

/// known_run: the only run, whose evaluations before `from` are in the summary already; nothing: all evaluations count.
void find_best_into(StoreSummary& summary, Database& database, const std::string& column,
                    std::optional<std::int64_t> known_run, std::uint64_t from) {
  const std::string score = sql_name(column);
  const std::string where = known_run ? "run = ?1 AND number >= ?2 AND " : "";
  Statement best(database, "SELECT number, " + score + " FROM evaluation WHERE " + where +
                               "given_up = 0 AND failure = '' ORDER BY " + score +
                               (summary.maximises ? " DESC" : " ASC") + ", run, number LIMIT 1");
  if (known_run) {
    best.bind_all(*known_run, static_cast<std::int64_t>(from));
  }
  if (!best.step() || best.is_null(1)) {
    return;
  }
  const double found = best.real(1);
  if (!summary.best || (summary.maximises ? found > summary.best_score : found < summary.best_score)) {
    summary.best = static_cast<std::uint64_t>(best.integer(0));
    summary.best_score = found;
  }
}

StoreSummary read_summary(const std::filesystem::path& path, Database& database, const StoreSummary* before) {
  require_store(path, database);
  StoreSummary summary;
  read_description_into(summary, database);
  const std::string column = read_objective_into(summary, database, path);
  const std::int64_t last_run = count_evaluations_into(summary, database);
  const bool is_known = before != nullptr && before->identity == summary.identity && before->runs == 1 &&
                        summary.runs == 1 && before->made <= summary.made;
  if (is_known) {
    summary.best = before->best;
    summary.best_score = before->best_score;
  }
  find_best_into(summary, database, column, is_known ? std::optional(last_run) : std::nullopt,
                 is_known ? before->made : 0);
  Statement ending(database, "SELECT ending FROM run WHERE run = ?1");
  ending.bind_all(last_run);
  if (ending.step()) {
    summary.ending = ending.text(0);
  }
  return summary;
}

/// Opens a store for reading, and turns the errors of SQLite into StoreError.
template <typename Read>
auto read_store(const std::filesystem::path& path, const Read& read) {
  try {
    require_store_file(path);
    Database database(path, SQLITE_OPEN_READONLY);
    return read(database);
  } catch (const SqliteError& error) {
    throw StoreError(path.string() + ": " + reason_of(error, 0));
  }
}

}  // namespace

StoreSummary read_store_summary(const std::filesystem::path& path, const StoreSummary* before) {
  return read_store(path, [&](Database& database) { return read_summary(path, database, before); });
}

std::string identity_of_store(const std::filesystem::path& path) {
  return read_store(path, [&](Database& database) {
    require_store(path, database);
    return identity_in(database);
  });
}

}  // namespace proleg::optimize
