#include "tools/proleg/ui/search_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/adaptation/trial_table.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/store_summary.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "tools/proleg/ui/folder_walk.hpp"
#include "tools/proleg/ui/search_folder.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using optimize::Evaluation;
using optimize::Experiment;

json number_or_null(double value) { return std::isfinite(value) ? json(value) : json(); }

/// What `proleg optimise` has left of its result; null: nothing that is an object.
json result_of(const fs::path& search) {
  constexpr std::uintmax_t most = 1 << 20;
  std::error_code error;
  const fs::path file = search / "result.json";
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > most) {
    return json();
  }
  std::ifstream stream(file);
  json result = json::parse(stream, nullptr, false);
  return result.is_object() ? result : json();
}

json dimensions_json(const optimize::SearchSpace& space) {
  json dimensions = json::array();
  for (std::size_t i = 0; i < space.dimensions.size(); ++i) {
    optimize::Candidate corner(space.dimensions.size(), 0);
    const double lowest = space.value(corner, i);
    corner[i] = static_cast<std::uint32_t>(space.dimensions[i].values.size() - 1);
    dimensions.push_back({{"name", space.dimensions[i].name},
                          {"unit", std::string(scale_of(space.dimensions[i].unit).symbol)},
                          {"count", space.dimensions[i].values.size()},
                          {"lowest", lowest},
                          {"highest", space.value(corner, i)}});
  }
  return dimensions;
}

json axes_json(const Experiment& experiment) {
  json axes = json::array();
  for (std::size_t i = 0; i < experiment.axes.size(); ++i) {
    const optimize::Objective& measure = experiment.objectives[1 + i];
    const optimize::MapAxis& axis = experiment.axes[i];
    axes.push_back({{"name", measure.name},
                    {"unit", measure.unit()},
                    {"lowest", axis.lowest},
                    {"highest", axis.highest},
                    {"cells", axis.cells}});
  }
  return axes;
}

/// The coordinates of each, 0 to 1; null: the map is a grid, or the search has none.
json centroids_json(const Experiment& experiment) {
  if (experiment.axes.empty()) {
    return json();
  }
  const optimize::GaitMap map(experiment);
  const optimize::Tessellation* const tessellation = map.tessellation();
  if (tessellation == nullptr) {
    return json();
  }
  json centroids = json::array();
  for (std::size_t i = 0; i < tessellation->count(); ++i) {
    const std::span<const double> centroid = tessellation->centroid(i);
    centroids.push_back(std::vector<double>(centroid.begin(), centroid.end()));
  }
  return centroids;
}

/// The text of a table of trials; nothing if it cannot be read, or is much larger than such tables are.
std::optional<std::string> text_of_trials(const fs::path& table) {
  constexpr std::uintmax_t most = 1 << 20;
  std::error_code error;
  if (fs::file_size(table, error) > most || error) {
    return std::nullopt;
  }
  try {
    return read_whole_file(table);
  } catch (const FileError&) {
    return std::nullopt;
  }
}

json trials_json(const optimize::TrialNotes& notes) {
  json trials = json::array();
  for (const optimize::NotedTrial& trial : notes.trials) {
    trials.push_back({{"cell", trial.place},
                      {"values", trial.values},
                      {"expected", trial.expected},
                      {"deviation", trial.deviation},
                      {"measured", trial.measured},
                      {"failure", text_or_null(one_line(trial.failure))}});
  }
  return trials;
}

/// The names of a dimension as `--set` takes them: it has a name for one joint and for all, a dimension also for some.
std::vector<std::string> setting_names(const Experiment& experiment, std::size_t dimension) {
  const optimize::Dimension& its = experiment.space.dimensions[dimension];
  const std::size_t colon = its.name.find(':');
  if (colon == std::string::npos || its.name.find(',', colon) == std::string::npos) {
    return {its.name};
  }
  std::vector<std::string> names;
  for (const Setting& target : its.targets) {
    names.push_back(its.name.substr(0, colon + 1).append(experiment.scenario.robot.joints[target.joint].name));
  }
  return names;
}

Evaluation evaluation_of(const Experiment& experiment, const fs::path& search, std::uint32_t run,
                         std::uint64_t number) {
  optimize::Store store(SearchFolder::store_of(search), experiment, {}, optimize::Store::Opening::look);
  std::vector<Evaluation> found = store.evaluations(run, number, 1);
  if (found.empty() || found.front().number != number) {
    throw InputError("number", 0, std::to_string(number), "the number of an evaluation");
  }
  return std::move(found.front());
}

}  // namespace

const Experiment& SearchResults::experiment_of(const fs::path& search) {
  constexpr std::size_t most = 4;
  const fs::path store = SearchFolder::store_of(search);
  std::string identity = optimize::identity_of_store(store);
  const auto found =
      std::ranges::find_if(open_, [&](const Open& open) { return open.search == search && open.identity == identity; });
  if (found != open_.end()) {
    open_.splice(open_.begin(), open_, found);
    return *open_.front().experiment;
  }
  open_.remove_if([&](const Open& open) { return open.search == search; });
  open_.push_front(
      {search, std::move(identity), std::make_unique<const Experiment>(optimize::read_experiment_of(store))});
  if (open_.size() > most) {
    open_.pop_back();
  }
  return *open_.front().experiment;
}

json SearchResults::describe(const fs::path& search) {
  const optimize::StoreSummary summary = optimize::read_store_summary(SearchFolder::store_of(search));
  const Experiment& experiment = experiment_of(search);
  json objectives = json::array();
  for (const optimize::Objective& objective : experiment.objectives) {
    objectives.push_back({{"name", objective.name},
                          {"unit", objective.unit()},
                          {"maximise", objective.goal == optimize::Goal::maximise}});
  }
  json measures = json::array();
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    measures.push_back(measure.name);
  }
  const bool has_ended = summary.ending && !optimize::is_being_written(SearchFolder::store_of(search));
  return {{"experiment", one_line(fs::path(experiment.path).filename().string())},
          {"method", optimize::method_name(experiment.method)},
          {"engine", std::string(optimize::trial_maker(experiment))},
          {"seed", std::to_string(experiment.seed)},
          {"trials", experiment.trials.count},
          {"planned", summary.planned > 0 ? json(summary.planned) : json()},
          {"runs", summary.runs},
          {"joints", experiment.scenario.robot.joints.size()},
          {"objectives", std::move(objectives)},
          {"dimensions", dimensions_json(experiment.space)},
          {"measures", std::move(measures)},
          {"has_baseline", experiment.has_baseline},
          {"axes", axes_json(experiment)},
          {"centroids", centroids_json(experiment)},
          {"result", has_ended ? result_of(search) : json()}};
}

json SearchResults::rows(const fs::path& search, std::uint32_t run, std::uint64_t from) {
  constexpr std::size_t most_rows = 1000;
  constexpr std::size_t most_numbers = 20'000;
  const Experiment& experiment = experiment_of(search);
  const std::size_t numbers_of_row = experiment.objectives.size() + experiment.space.dimensions.size();
  const std::size_t most =
      std::clamp<std::size_t>(most_numbers / std::max<std::size_t>(numbers_of_row, 1), 1, most_rows);
  optimize::Store store(SearchFolder::store_of(search), experiment, {}, optimize::Store::Opening::look);
  json scores = json::array();
  json values = json::array();
  json flags = json::array();
  for (const Evaluation& evaluation : store.evaluations(run, from, most)) {
    json its_scores = json::array();
    for (const double score : evaluation.scores) {
      its_scores.push_back(number_or_null(score));
    }
    json its_values = json::array();
    for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
      its_values.push_back(experiment.space.value(evaluation.candidate, i));
    }
    scores.push_back(std::move(its_scores));
    values.push_back(std::move(its_values));
    bool has_others = true;
    for (std::size_t i = 1; i < experiment.objectives.size(); ++i) {
      has_others = has_others && optimize::has_own_score(experiment, evaluation, i);
    }
    flags.push_back((optimize::has_own_score(experiment, evaluation, 0) ? 0 : 1) + (evaluation.given_up ? 2 : 0) +
                    (evaluation.reused ? 4 : 0) + (has_others ? 0 : 8));
  }
  return {{"from", from},
          {"made", store.evaluation_count(run)},
          {"scores", std::move(scores)},
          {"values", std::move(values)},
          {"flags", std::move(flags)}};
}

json SearchResults::candidate(const fs::path& search, std::uint32_t run, std::uint64_t number) {
  const Experiment& experiment = experiment_of(search);
  const Evaluation evaluation = evaluation_of(experiment, search, run, number);
  json scores = json::array();
  for (const double score : evaluation.scores) {
    scores.push_back(number_or_null(score));
  }
  json words = json::array();
  for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
    const std::string value = experiment.space.value_text(evaluation.candidate, i);
    for (const std::string& name : setting_names(experiment, i)) {
      words.push_back(std::string(name).append("=").append(value));
    }
  }
  json measures = json::object();
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    measures[std::string(measure.name)] = number_or_null(evaluation.measures[measure.measure]);
  }
  return {{"number", evaluation.number},
          {"scores", std::move(scores)},
          {"words", std::move(words)},
          {"measures", std::move(measures)},
          {"failure", text_or_null(one_line(evaluation.failure))},
          {"given_up", evaluation.given_up},
          {"reused", evaluation.reused}};
}

json SearchResults::adaptations(const fs::path& search, const fs::path& folder) {
  constexpr std::array<const char*, 1> tables{"trials.tsv"};
  const std::size_t axes = experiment_of(search).axes.size();
  std::vector<std::pair<fs::file_time_type, json>> found;
  for (const std::string& name : axes == 0 ? std::vector<std::string>() : folders_with(folder, tables, {})) {
    std::error_code error;
    const fs::path table = folder / name / tables.front();
    const fs::file_time_type time = fs::last_write_time(table, error);
    const std::optional<std::string> text = text_of_trials(table);
    const std::optional<optimize::TrialNotes> notes = text ? optimize::look_at_trials(*text, axes) : std::nullopt;
    if (notes && fs::weakly_canonical(folder / name / notes->comments.atlas, error) == search) {
      found.emplace_back(time, json{{"name", name},
                                    {"robot", one_line(notes->comments.robot)},
                                    {"diagnosis", text_or_null(one_line(notes->comments.diagnosis))},
                                    {"trials", trials_json(*notes)}});
    }
  }
  std::ranges::sort(found, [](const auto& a, const auto& b) { return a.first > b.first; });
  json adaptations = json::array();
  for (auto& [time, adaptation] : found) {
    adaptations.push_back(std::move(adaptation));
  }
  return {{"adaptations", std::move(adaptations)}};
}

sim::Scenario SearchResults::scenario_of(const fs::path& search, std::uint32_t run, std::uint64_t number) {
  const Experiment& experiment = experiment_of(search);
  return optimize::own_world(experiment, evaluation_of(experiment, search, run, number));
}

}  // namespace proleg::tools
