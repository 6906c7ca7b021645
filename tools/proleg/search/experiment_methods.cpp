#include "tools/proleg/search/experiment_methods.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/search/search_result.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// The methods of the experiment, and the other algorithms of pagmo that search for one objective.
std::vector<ExperimentMethod> all_methods(const optimize::ThesisExperiment& thesis) {
  std::vector<ExperimentMethod> methods;
  for (const optimize::ThesisMethod& method : thesis.methods) {
    methods.push_back({std::string(method.name), std::string(method.file), std::string(method.table),
                       std::string(method.runs_figure), std::string(method.spread_figure)});
  }
  for (const optimize::PagmoAlgorithm& algorithm : optimize::pagmo_algorithms()) {
    const std::string name(algorithm.name);
    if (algorithm.objectives != optimize::PagmoAlgorithm::Objectives::several && name != "cmaes") {
      methods.push_back({name, "cma_es.optimise.xml", "table_" + name + ".tsv", "figure_" + name + "_runs.svg",
                         "figure_" + name + "_spread.svg", false});
    }
  }
  return methods;
}

/// Throws InputError unless a method has the name.
void check_method_name(const std::vector<ExperimentMethod>& methods, const std::string& name) {
  if (std::ranges::count(methods, name, &ExperimentMethod::name) == 0) {
    std::vector<std::string> names;
    std::ranges::transform(methods, std::back_inserter(names), &ExperimentMethod::name);
    throw InputError("--method", 0, in_quotes(name), "one of " + listed(names));
  }
}

optimize::Experiment experiment_of(const MethodChoice& choice, const ExperimentMethod& method) {
  sim::DiskFiles files;
  optimize::Experiment experiment = optimize::read_experiment(choice.scenarios / method.file, files);
  if (!method.shipped) {
    optimize::PagmoSettings settings;
    settings.algorithm = method.name;
    experiment.method = settings;
  }
  experiment.has_baseline = false;  // the thesis's searches have no baseline; the references are in the summary
  apply_options(choice.options, experiment);
  return experiment;
}

/// Whether the store in a folder has all repetitions of this experiment. Its method is then part of the comparison,
/// even if the user did not name it.
bool is_complete(const optimize::Experiment& experiment, std::uint32_t repetitions, const fs::path& folder) {
  try {
    optimize::Store store(store_path(folder), experiment, result_key, optimize::Store::Opening::resume);
    for (std::uint32_t run = 0; run < repetitions; ++run) {
      if (!has_ended(store, experiment, run)) {
        return false;
      }
    }
    return true;
  } catch (const optimize::StoreError&) {
    return false;  // the folder has no store, or one of another experiment
  }
}

}  // namespace

const optimize::ThesisExperiment& find_experiment(const std::string& name) {
  std::vector<std::string> names;
  for (const optimize::ThesisExperiment* experiment : optimize::thesis_experiments()) {
    if (experiment->name == name) {
      return *experiment;
    }
    names.push_back(in_quotes(experiment->name));
  }
  throw InputError(name, 0, "unknown experiment " + in_quotes(name), listed(names));
}

fs::path find_experiment_files(const optimize::ThesisExperiment& thesis, const std::optional<std::string>& given) {
  const std::string name(thesis.name);
  const std::string file(thesis.methods.front().file);
  const fs::path inside = fs::path("sim") / "scenarios" / name;
  std::vector<fs::path> candidates;
  if (given) {
    candidates.emplace_back(*given);
  } else {
    candidates.push_back(inside);
    std::error_code error;
    for (fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path(); folder.has_relative_path();
         folder = folder.parent_path()) {
      candidates.push_back(folder / inside);
    }
  }
  for (const fs::path& folder : candidates) {
    if (fs::is_regular_file(folder / file)) {
      return folder;
    }
  }
  throw InputError(given ? "--scenarios" : name, 0, "no " + (candidates.front() / file).string(),
                   "the experiment's files; give their folder with --scenarios");
}

std::vector<ChosenMethod> choose_methods(const optimize::ThesisExperiment& thesis, const MethodChoice& choice) {
  const std::vector<ExperimentMethod> methods = all_methods(thesis);
  for (const std::string& name : choice.names) {
    check_method_name(methods, name);
  }
  std::vector<ChosenMethod> chosen;
  for (const ExperimentMethod& method : methods) {
    const bool is_asked_for = choice.names.empty() ? method.shipped : std::ranges::count(choice.names, method.name) > 0;
    const fs::path folder = choice.folder / method.name;
    if (!is_asked_for && !fs::exists(store_path(folder))) {
      continue;
    }
    optimize::Experiment experiment = experiment_of(choice, method);
    if (is_asked_for || is_complete(experiment, choice.repetitions, folder)) {
      refuse_overwriting(experiment, folder);
      if (!fs::exists(store_path(folder))) {
        check_result_folder(folder, search_result_files);
      }
      chosen.push_back({method, std::move(experiment)});
    }
  }
  return chosen;
}

}  // namespace proleg::tools
