#include "sim/optimize/evaluation/store_summary.hpp"

#include <string_view>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/evaluation/store_schema.hpp"

namespace proleg::optimize {
namespace {

StoreSummary read_summary(const std::filesystem::path& path, Database& database, const StoreSummary* before) {
  require_store(path, database);
  StoreSummary summary;
  summary.method = described_value(database, "method");
  summary.scenario = described_value(database, "scenario");
  summary.started = described_value(database, "started");
  const std::string planned = described_value(database, "planned");  // stores of earlier programs do not have it
  summary.planned =
      parse_whole<std::uint64_t>(planned.empty() ? described_value(database, "evaluations") : planned).value_or(0);
  Statement objective(database, "SELECT name, column_name, goal, terms FROM objective ORDER BY position LIMIT 1");
  if (!objective.step()) {
    throw StoreError(path.string() + ": has no objective");
  }
  summary.objective = objective.text(0);
  const std::string column = objective.text(1);
  summary.maximises = objective.text(2) == "maximise";
  Statement unit(database, "SELECT unit FROM measure WHERE name = ?1");
  constexpr std::string_view once = "1 * ";  // terms_text() of a single measure
  const std::string terms = objective.text(3);
  const std::string_view measure = terms.starts_with(once) ? std::string_view(terms).substr(once.size()) : "";
  unit.bind_all(measure);
  summary.unit = unit.step() ? unit.text(0) : std::string();
  Statement last_run(database, "SELECT coalesce(max(run), 0) + 1 FROM evaluation");
  summary.runs = last_run.step() ? static_cast<std::uint32_t>(last_run.integer(0)) : 1;
  Statement count(database, "SELECT coalesce(max(number) + 1, 0) FROM evaluation WHERE run = ?1");
  for (std::uint32_t run = 0; run < summary.runs; ++run) {
    count.bind_all(run);
    summary.made += count.step() ? static_cast<std::uint64_t>(count.integer(0)) : 0;
  }
  const bool is_known = before != nullptr && before->runs == 1 && summary.runs == 1 && before->made <= summary.made;
  if (is_known) {
    summary.best = before->best;
    summary.best_score = before->best_score;
  }
  const std::string score = sql_name(column);
  Statement best(database, "SELECT number, " + score +
                               " FROM evaluation WHERE number >= ?1 AND given_up = 0 AND failure = '' ORDER BY " +
                               score + (summary.maximises ? " DESC" : " ASC") + ", run, number LIMIT 1");
  best.bind_all(is_known ? before->made : std::uint64_t{0});
  if (best.step() && !best.is_null(1)) {
    const double found = best.real(1);
    if (!summary.best || (summary.maximises ? found > summary.best_score : found < summary.best_score)) {
      summary.best = static_cast<std::uint64_t>(best.integer(0));
      summary.best_score = found;
    }
  }
  Statement ending(database, "SELECT ending FROM run WHERE run = ?1");
  ending.bind_all(summary.runs - 1);
  if (ending.step()) {
    summary.ending = ending.text(0);
  }
  return summary;
}

}  // namespace

StoreSummary read_store_summary(const std::filesystem::path& path, const StoreSummary* before) {
  try {
    require_store_file(path);
    Database database(path, SQLITE_OPEN_READONLY);
    return read_summary(path, database, before);
  } catch (const SqliteError& error) {
    throw StoreError(path.string() + ": " + reason_of(error, 0));
  }
}

}  // namespace proleg::optimize
