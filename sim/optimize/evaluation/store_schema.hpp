#pragma once

// The tables of a store and their rows. Comments inside the SQL are kept in the file: `.schema` in the sqlite3 shell
// shows them.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/sqlite/sqlite.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// "PrOp", SQLite's application id: it distinguishes a store from other databases.
inline constexpr std::uint32_t store_application_id = 0x50724F70;
/// SQLite's user_version. It grows when a program for the older format would misread or miss something.
inline constexpr std::uint32_t store_format = 1;

/// Names of the columns that depend on the experiment. SQLite ignores their case, so a name that is already used gets
/// "_" at its end.
struct StoreColumns {
  explicit StoreColumns(const Experiment& experiment);

  std::vector<std::string> scores;    ///< "score distance": one for each objective
  std::vector<std::string> values;    ///< "amplitude:J5": one for each dimension; none if a table cannot hold them all
  std::vector<std::string> measures;  ///< "distance"
};

/// SQL that makes all tables.
[[nodiscard]] std::string store_schema(const Experiment& experiment, const StoreColumns& columns);

/// A name as SQL has it: between double quotes.
[[nodiscard]] std::string sql_name(std::string_view name);

/// SQL that inserts or replaces a row: "table(a, b) VALUES(?1, ?2)".
[[nodiscard]] std::string replace_row(const std::string& table, const std::vector<std::string>& columns);

/// Columns of the tables trial and evaluation, in the order in which the store gives them their values.
[[nodiscard]] std::vector<std::string> trial_columns(const StoreColumns& columns);
[[nodiscard]] std::vector<std::string> evaluation_columns(const StoreColumns& columns);

// Rows of a store's tables: the order of their columns is that of trial_columns() and evaluation_columns(). All throw
// SqliteError.

/// statement: replace_row("trial", ...). seed: of the trial.
void save_trial_row(Statement& statement, const Task& task, std::uint64_t seed, const TrialResult& result,
                    std::uint32_t worker);

/// The result in a row of the table trial; nothing if the row is of another candidate or limit than the task's.
[[nodiscard]] std::optional<TrialResult> read_trial(Statement& statement, const Task& task);

/// statement: replace_row("evaluation", ...).
void save_evaluation_row(Statement& statement, const Experiment& experiment, const StoreColumns& columns,
                         const Evaluation& evaluation);

/// The evaluation in a row of the table evaluation.
[[nodiscard]] Evaluation read_evaluation(Statement& statement, const Experiment& experiment,
                                         const StoreColumns& columns);

}  // namespace proleg::optimize
