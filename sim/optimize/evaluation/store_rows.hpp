#pragma once

// Rows of a store's tables: the order of their columns is that of trial_columns() and evaluation_columns(). All throw
// SqliteError.

#include <cstdint>
#include <optional>

#include "shared/computer/sqlite/sqlite.hpp"
#include "sim/optimize/evaluation/store_schema.hpp"
#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

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
