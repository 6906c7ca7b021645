#include "tools/proleg/search/search_result.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "shared/computer/output/output.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/run_measures.hpp"
#include "tools/proleg/search/map_result.hpp"

namespace proleg::tools {
namespace {

using optimize::Confirmation;
using optimize::Evaluation;
using optimize::Experiment;

bool depends_on_seed(const Experiment& experiment) {
  return optimize::depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread);
}

/// Measures of the scenario that is written for an evaluation.
sim::MeasureValues own_measures(const Experiment& experiment, const Evaluation& evaluation) {
  const bool was_tried = experiment.on_robot || (experiment.trials.count == 1 && !experiment.trials.spread.any() &&
                                                 !optimize::is_judged(experiment));
  return was_tried ? evaluation.measures : optimize::run_own_world(experiment, evaluation).measures;
}

std::vector<double> scores_of(const Experiment& experiment, const sim::MeasureValues& measures) {
  std::vector<double> scores;
  for (const optimize::Objective& objective : experiment.objectives) {
    scores.push_back(objective.score(measures));
  }
  return scores;
}

/// Whether the best scenario's own run decided the result: a judged search without random numbers has one fresh run of
/// each finalist, in the world of the scenario.
bool own_run_decided(const Experiment& experiment, const SearchResult& result) {
  return optimize::is_judged(experiment) && !depends_on_seed(experiment) && !result.confirmations.empty();
}

/// The numbers that decide between the best and the baseline: the means of their fresh runs, or their scores in the
/// search.
struct Comparison {
  double best;
  double baseline;
};

/// Compares the best with the baseline; nothing without a score of the baseline.
std::optional<Comparison> compare_with_baseline(const Experiment& experiment, const SearchResult& result) {
  if (!result.baseline || !optimize::has_own_score(experiment, *result.baseline, 0)) {
    return std::nullopt;
  }
  const Confirmation* const best = result.confirmation_of(result.best);
  const Confirmation* const baseline = result.confirmation_of(*result.baseline);
  if (best != nullptr && baseline != nullptr) {
    return Comparison{best->mean, baseline->mean};
  }
  return Comparison{result.best.scores.front(), result.baseline->scores.front()};
}

/// Gain of the best over the baseline, in per cent of the baseline.
std::optional<double> gain_percent(const Experiment& experiment, const SearchResult& result) {
  const std::optional<Comparison> scores = compare_with_baseline(experiment, result);
  if (!scores || scores->baseline == 0.0) {
    return std::nullopt;
  }
  const double gain = 100.0 * (scores->best - scores->baseline) / std::abs(scores->baseline);
  return (experiment.objectives.front().goal == optimize::Goal::maximise ? gain : -gain) + 0.0;
}

/// Whether the search found a candidate that is better than the baseline; nothing without a score of the baseline.
std::optional<bool> beats_baseline(const Experiment& experiment, const SearchResult& result) {
  const std::optional<Comparison> scores = compare_with_baseline(experiment, result);
  if (!scores) {
    return std::nullopt;
  }
  return result.best.candidate != result.baseline->candidate &&
         experiment.objectives.front().better(scores->best, scores->baseline);
}

/// Text after a score: the engine that gave it, if the search has two engines.
std::string engine_text(const Experiment& experiment, sim::PhysicsEngine engine) {
  return optimize::is_judged(experiment) ? " (" + std::string(sim::name_of(engine)) + ")" : "";
}

std::string search_engine_text(const Experiment& experiment) {
  return engine_text(experiment, experiment.scenario.environment.engine);
}

std::string judge_text(const Experiment& experiment) { return engine_text(experiment, optimize::judging_engine); }

std::string number_text(double value, std::string_view unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data() + (unit.empty() ? "" : " " + std::string(unit));
}

std::string confirmation_text(const Experiment& experiment, const Confirmation& confirmation) {
  const std::string_view unit = experiment.objectives.front().unit();
  std::array<char, 96> runs{};
  std::snprintf(runs.data(), runs.size(), "standard deviation %.2g, worst %.6g, %zu fresh runs",
                confirmation.standard_deviation, confirmation.worst, confirmation.scores.size());
  return "mean " + number_text(confirmation.mean, unit) + ", " + runs.data() + judge_text(experiment);
}

void print_baseline(const Experiment& experiment, const SearchResult& result) {
  if (!result.baseline) {
    return;
  }
  const Evaluation& baseline = *result.baseline;
  if (!optimize::has_own_score(experiment, baseline, 0)) {
    print_line("baseline", "has no score: " + optimize::why_without_score(experiment, baseline));
    return;
  }
  const std::string_view unit = experiment.objectives.front().unit();
  const Confirmation* const confirmation = result.confirmation_of(baseline);
  const bool is_decided = own_run_decided(experiment, result) && confirmation != nullptr;
  const std::string searched = number_text(baseline.scores.front(), unit) + search_engine_text(experiment);
  std::string text = is_decided ? number_text(confirmation->mean, unit) + judge_text(experiment) : searched;
  if (const std::optional<double> gain = gain_percent(experiment, result)) {
    std::array<char, 32> percent{};
    std::snprintf(percent.data(), percent.size(), ", gain %.1f %%", *gain);
    text += percent.data();
  }
  print_line("baseline", text);
  if (result.better_than_baseline == false) {
    print_line("no gain", result.moved.empty() ? "no candidate was better than the scenario's own"
                                               : "no candidate was better than the baseline");
  }
  if (is_decided) {
    print_line("  in the search", searched);
  } else if (confirmation != nullptr) {
    print_line("  in fresh runs", confirmation_text(experiment, *confirmation));
  }
  for (const optimize::MovedValue& value : result.moved) {
    print_line("  " + value.name, "the scenario's " + value.own + (value.unit.empty() ? "" : " ") + value.unit +
                                      " is not in the search space; the baseline has " + value.nearest);
  }
}

/// Text of a value with its unit.
std::string value_text(const Experiment& experiment, const optimize::Candidate& candidate, std::size_t dimension) {
  const std::string unit = sim::shown_unit(experiment.space.dimensions[dimension].unit);
  return experiment.space.value_text(candidate, dimension) + (unit.empty() ? "" : " ") + unit;
}

void print_best(const Experiment& experiment, const SearchResult& result) {
  const Evaluation& best = result.best;
  const bool is_decided = own_run_decided(experiment, result);
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    const optimize::Objective& objective = experiment.objectives[i];
    const std::string searched = number_text(best.scores[i], objective.unit()) + search_engine_text(experiment);
    print_line("best " + objective.name,
               is_decided ? number_text(result.own_scores[i], objective.unit()) + judge_text(experiment) : searched);
    if (is_decided) {
      print_line("  in the search", searched);
    }
  }
  const Confirmation* const confirmation = result.confirmation_of(best);
  if (confirmation != nullptr && !is_decided) {
    print_line("  in fresh runs", confirmation_text(experiment, *confirmation));
  }
  const std::string_view unit = experiment.objectives.front().unit();
  const std::string own_score = number_text(result.own_scores.front(), unit);
  if (depends_on_seed(experiment) && !is_decided && own_score != number_text(best.scores.front(), unit)) {
    print_line("  in its own world", own_score + ", the best scenario" + judge_text(experiment));
  }
  if (optimize::is_judged(experiment) && confirmation == nullptr) {
    print_line("not judged",
               "interrupted before the best candidates ran in " + std::string(sim::name_of(optimize::judging_engine)));
  }
  for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
    const optimize::Dimension& dimension = experiment.space.dimensions[i];
    print_line("  " + dimension.name, value_text(experiment, best.candidate, i));
  }
  for (const optimize::ValueAtBound& bound : result.at_bounds) {
    const optimize::Dimension& dimension = experiment.space.dimensions[bound.dimension];
    print_line("at a bound", dimension.name + " = " + value_text(experiment, best.candidate, bound.dimension) +
                                 " is the " + (bound.is_highest ? "highest" : "lowest") +
                                 " value of its range: a wider range may give more");
  }
}

Json confirmation_object(const Confirmation& confirmation) {
  return {{"number", confirmation.evaluation.number},
          {"score", confirmation.evaluation.scores.front()},
          {"runs", confirmation.scores.size()},
          {"mean", confirmation.mean},
          {"standard_deviation", confirmation.standard_deviation},
          {"worst", confirmation.worst},
          {"scores", confirmation.scores}};
}

Json scores_object(const Experiment& experiment, const std::vector<double>& scores) {
  Json object = Json::empty_object();
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    object.add(experiment.objectives[i].name, scores[i]);
  }
  return object;
}

Json baseline_object(const Experiment& experiment, const SearchResult& result) {
  if (!result.baseline) {
    return {};
  }
  const Evaluation& baseline = *result.baseline;
  const bool has_score = optimize::has_own_score(experiment, baseline, 0);
  Json moved = Json::empty_array();
  for (const optimize::MovedValue& value : result.moved) {
    moved.append({{"dimension", value.name}, {"scenario", value.own}, {"baseline", value.nearest}});
  }
  const Confirmation* const confirmation = result.confirmation_of(baseline);
  const bool is_decided = own_run_decided(experiment, result) && confirmation != nullptr;
  Json object{{"score", is_decided  ? Json(confirmation->mean)
                        : has_score ? Json(baseline.scores.front())
                                    : Json()},
              {"search_score", has_score ? Json(baseline.scores.front()) : Json()},
              {"scores", scores_object(experiment, baseline.scores)},
              {"values", values_object(experiment.space, baseline.candidate)},
              {"moved", moved}};
  if (!has_score) {
    object.add("failure", optimize::why_without_score(experiment, baseline));
  }
  return object;
}

}  // namespace

const Confirmation* SearchResult::confirmation_of(const Evaluation& evaluation) const {
  const auto found = std::ranges::find_if(confirmations, [&](const Confirmation& confirmation) {
    return confirmation.evaluation.candidate == evaluation.candidate;
  });
  return found == confirmations.end() ? nullptr : &*found;
}

SearchResult result_of(const Experiment& experiment, const SearchOutcome& outcome,
                       std::vector<Confirmation> confirmations) {
  SearchResult result;
  result.confirmations = std::move(confirmations);
  result.best = result.confirmations.empty() ? *outcome.progress.best : result.confirmations.front().evaluation;
  result.own_measures = own_measures(experiment, result.best);
  result.own_scores = scores_of(experiment, result.own_measures);
  if (const Evaluation* const baseline = optimize::baseline_of(experiment, outcome.evaluations)) {
    result.baseline = *baseline;
    result.moved = optimize::values_outside_space(experiment);
  }
  result.better_than_baseline = beats_baseline(experiment, result);
  if (result.better_than_baseline != false) {
    result.at_bounds = optimize::values_at_bounds(experiment, result.best.candidate);
  }
  return result;
}

void refuse_overwriting(const Experiment& experiment, const std::filesystem::path& folder,
                        std::span<const std::string_view> files) {
  const auto is_written = [&](const std::filesystem::path& inside) {
    const std::string name = inside.empty() ? std::string() : inside.begin()->string();
    return name.starts_with("store.sqlite") || std::ranges::count(files, name) > 0;
  };
  for (const sim::SourceFile& source : experiment.sources) {
    const std::filesystem::path path = std::filesystem::weakly_canonical(source.path);
    const std::filesystem::path inside = path.lexically_relative(std::filesystem::weakly_canonical(folder));
    if (is_written(inside)) {
      throw BadInput(source.path +
                     ": found a file of the experiment that the search would write over, expected another "
                     "folder (--out) than " +
                     folder.string());
    }
  }
}

std::vector<std::filesystem::path> write_results(const Experiment& experiment, const SearchOutcome& outcome,
                                                 const SearchResult* result, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  const auto write = [&](const char* name, const std::string& text) {
    files.push_back(folder / name);
    write_file(files.back(), text);
  };
  write("evaluations.tsv", optimize::evaluations_table(experiment, outcome.evaluations));
  write("best.tsv", optimize::best_table(experiment, outcome.evaluations, 10));
  write("learning_curve.svg", optimize::draw_learning_curve(experiment, outcome.evaluations));
  if (result != nullptr && !result->confirmations.empty()) {
    write("confirmation.tsv", optimize::confirmation_table(experiment, result->confirmations));
  }
  if (!experiment.axes.empty()) {
    write("map.tsv", optimize::gait_map_table(experiment, outcome.evaluations));
    write("map.svg", optimize::draw_gait_map(experiment, outcome.evaluations));
  } else if (experiment.objectives.size() > 1) {
    std::vector<Evaluation> front;
    for (const std::size_t position : optimize::pareto_front(experiment, outcome.evaluations)) {
      front.push_back(outcome.evaluations[position]);
    }
    write("pareto.tsv", optimize::evaluations_table(experiment, front));
    write("pareto.svg", optimize::draw_pareto_front(experiment, outcome.evaluations));
  }
  if (result != nullptr) {
    files.push_back(optimize::write_scenario(experiment, result->best, folder, "best"));
  }
  return files;
}

void print_result(const Experiment& experiment, const SearchOutcome& outcome, const SearchResult& result) {
  print_best(experiment, result);
  print_baseline(experiment, result);
  if (!experiment.axes.empty()) {
    print_line("map", map_text(optimize::gait_map(experiment, outcome.evaluations)));
  }
  const optimize::SearchProgress& progress = outcome.progress;
  std::printf("%-24s %llu: %llu %s now, %llu reused, %llu from the store\n", "evaluations",
              static_cast<unsigned long long>(progress.evaluations),
              static_cast<unsigned long long>(progress.simulated), experiment.on_robot ? "tried" : "simulated",
              static_cast<unsigned long long>(progress.reused), static_cast<unsigned long long>(progress.restored));
  if (progress.failed > 0) {
    print_line("failed", std::to_string(progress.failed) + " of them; the first: " + progress.first_failure);
  }
  print_line("ended", ending_text(outcome));
}

void add_result(const Experiment& experiment, const SearchOutcome& outcome, const SearchResult& result, Json& object) {
  const Evaluation& best = result.best;
  const bool is_decided = own_run_decided(experiment, result);
  const std::vector<double>& scores = is_decided ? result.own_scores : best.scores;
  object.add("best_score", scores.front());
  object.add("best_scores", scores_object(experiment, scores));
  object.add("best_search_scores", scores_object(experiment, best.scores));
  object.add("best_values", values_object(experiment.space, best.candidate));
  object.add("best_number", best.number);
  object.add("best_measures", measures_object(is_decided ? result.own_measures : best.measures));
  object.add("best_scenario_score", result.own_scores.front());
  object.add("best_scenario_scores", scores_object(experiment, result.own_scores));
  object.add("baseline", baseline_object(experiment, result));
  object.add("better_than_baseline", result.better_than_baseline);
  object.add("gain_percent", gain_percent(experiment, result));
  Json confirmations = Json::empty_array();
  for (const Confirmation& confirmation : result.confirmations) {
    confirmations.append(confirmation_object(confirmation));
  }
  const Confirmation* const confirmed = result.confirmation_of(best);
  object.add("confirmed_mean", confirmed != nullptr ? Json(confirmed->mean) : Json());
  object.add("confirmed_standard_deviation", confirmed != nullptr ? Json(confirmed->standard_deviation) : Json());
  object.add("confirmations", confirmations);
  Json bounds = Json::empty_array();
  for (const optimize::ValueAtBound& bound : result.at_bounds) {
    bounds.append({{"dimension", experiment.space.dimensions[bound.dimension].name},
                   {"value", experiment.space.value(best.candidate, bound.dimension)},
                   {"bound", bound.is_highest ? "highest" : "lowest"}});
  }
  object.add("at_bounds", bounds);
  if (!experiment.axes.empty()) {
    object.add("map", map_object(optimize::gait_map(experiment, outcome.evaluations)));
  }
}

}  // namespace proleg::tools
