#include "tools/proleg/ui/search_form.hpp"

#include <map>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* file_of_form = "search.optimise.xml";

/// Where a message names the field itself: "method: found ...".
FormProblem problem_of_text(const InputError& error) {
  const std::string_view what = error.what();
  const std::string_view problem = error.problem();
  const std::string_view place = what.substr(0, what.size() - problem.size());
  return {std::string(place.substr(0, place.find(':'))), std::string(problem)};
}

}  // namespace

std::variant<optimize::Experiment, FormProblem> judge_form(const optimize::ExperimentForm& form,
                                                           const sim::Scenario& scenario) {
  optimize::ExperimentText text;
  try {
    text = optimize::experiment_text(form, scenario, fs::path(scenario.path).filename().string());
  } catch (const InputError& error) {
    return problem_of_text(error);
  }
  sim::SourceTexts files;
  files.add(file_of_form, text.text);
  try {
    optimize::Experiment experiment = optimize::read_experiment(file_of_form, files, scenario);
    optimize::check_method(experiment);
    return experiment;
  } catch (const InputError& error) {
    const auto line = static_cast<std::size_t>(error.line());
    const bool is_in_form = line > 0 && line <= text.fields.size();
    return FormProblem{is_in_form ? text.fields[line - 1] : std::string(), error.problem()};
  }
}

fs::path write_search_files(const optimize::ExperimentForm& form, const sim::Scenario& scenario, const fs::path& folder,
                            const std::string& name) {
  const std::map<std::string, std::string> copies = copy_sources(scenario.sources, folder / ".scenario");
  const fs::path top = copies.at(scenario.sources.front().path);
  const fs::path file = folder / (name + ".optimise.xml");
  const fs::path simulation = fs::weakly_canonical(top).lexically_relative(fs::weakly_canonical(folder));
  write_file(file, optimize::experiment_text(form, scenario, simulation.string()).text);
  return file;
}

}  // namespace proleg::tools
