#pragma once

// The form of a search, judged for a scenario, and written as the files of a search.

#include <filesystem>
#include <string>
#include <variant>

#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/experiment_form.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Why a form is no experiment.
struct FormProblem {
  std::string field;  ///< "parameters.0.upper"; empty: of no single field
  std::string text;   ///< "found ..., expected ..."
};

/// The experiment that the form makes of the scenario, as the reader of experiment files and `proleg optimise` judge
/// it; the engine is not judged.
[[nodiscard]] std::variant<optimize::Experiment, FormProblem> judge_form(const optimize::ExperimentForm& form,
                                                                         const sim::Scenario& scenario);

/// Writes the files of a search into a folder that exists: a copy of the scenario, which the person may go on changing,
/// below `.scenario`, where lists of scenarios do not look, and `name`.optimise.xml, whose path is returned. Throws
/// InputError and FileError; what was written then stays.
[[nodiscard]] std::filesystem::path write_search_files(const optimize::ExperimentForm& form,
                                                       const sim::Scenario& scenario,
                                                       const std::filesystem::path& folder, const std::string& name);

}  // namespace proleg::tools
