#include "sim/optimize/report/thesis_experiment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "sim/optimize/report/method_runs.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/optimize/report/thesis_data.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {
namespace {

using sim::plain_number;

constexpr int distance_decimals = 3;

/// The best evaluation of each repetition that has any, by the scores of the search, best first.
std::vector<const Evaluation*> best_of_searches(const MethodRuns& method) {
  std::vector<const Evaluation*> best;
  for (const std::vector<Evaluation>& run : method.runs) {
    const auto winner = std::ranges::max_element(run, {}, [](const Evaluation& e) { return e.scores.front(); });
    if (winner != run.end()) {
      best.push_back(&*winner);
    }
  }
  std::ranges::stable_sort(best, std::ranges::greater{}, [](const Evaluation* e) { return e->scores.front(); });
  return best;
}

/// The best evaluation of each repetition by the scores of the judging engine, if these exist, best first.
std::vector<const Evaluation*> best_of_runs(const MethodRuns& method) {
  if (method.judged.empty()) {
    return best_of_searches(method);
  }
  std::vector<const Evaluation*> best;
  for (const Evaluation& winner : method.judged) {
    best.push_back(&winner);
  }
  std::ranges::stable_sort(best, std::ranges::greater{}, [](const Evaluation* e) { return e->scores.front(); });
  return best;
}

/// Pads a text with blanks, aligned left, or right if the width is below 0.
std::string padded(std::string text, int width) {
  const auto size = static_cast<std::size_t>(std::abs(width));
  if (text.size() < size) {
    text.insert(width < 0 ? 0 : text.size(), size - text.size(), ' ');
  }
  return text;
}

struct Statistics {
  double mean = NAN;
  double deviation = NAN;  ///< sample standard deviation; NaN for less than two
};

Statistics statistics_of(const std::vector<const Evaluation*>& evaluations) {
  Statistics result;
  const auto count = static_cast<double>(evaluations.size());
  double sum = 0.0;
  for (const Evaluation* evaluation : evaluations) {
    sum += evaluation->scores.front();
  }
  result.mean = sum / count;
  double squares = 0.0;
  for (const Evaluation* evaluation : evaluations) {
    squares += std::pow(evaluation->scores.front() - result.mean, 2);
  }
  if (evaluations.size() > 1) {
    result.deviation = std::sqrt(squares / (count - 1.0));
  }
  return result;
}

std::string number_or_dash(double value, int decimals) {
  return std::isfinite(value) ? fixed_text(value, decimals) : "-";
}

std::string gain_text(double distance, double uniform) {
  const double percent = 100.0 * (distance / uniform - 1.0);
  return std::isfinite(percent) ? (percent < 0.0 ? "" : "+") + fixed_text(percent, 1) + " %" : "-";
}

using Row = std::array<std::string, 8>;
std::string row_text(const Row& row) {
  constexpr std::array<int, 8> widths{21, -6, -14, -12, -9, -9, -11, -14};
  std::string text;
  for (std::size_t i = 0; i < row.size(); ++i) {
    text += padded(row[i], widths[i]);
  }
  return text + "\n";
}

/// The value of the best evaluation that the experiment shows.
std::string shown_value(const ThesisExperiment& experiment, const MethodRuns& method, const Evaluation& best) {
  const std::vector<ThesisRow> rows = experiment.rows(method.space);
  if (experiment.shown_row >= rows.size()) {
    return "-";
  }
  return method.space.value_text(best.candidate, rows[experiment.shown_row].dimension) + " " +
         std::string(experiment.shown_unit);
}

Row method_row(const ThesisExperiment& experiment, const MethodRuns& method, double reference_m) {
  const std::vector<const Evaluation*> best = best_of_runs(method);
  if (best.empty()) {
    return {method.method, "0", "-", "-", "-", "-", "-", "-"};
  }
  const auto [min, max] = std::ranges::minmax(method.runs, {}, &std::vector<Evaluation>::size);
  const Statistics statistics = statistics_of(best);
  const double distance = best.front()->scores.front();
  return {method.method,
          std::to_string(best.size()),
          std::to_string(min.size()) + (min.size() == max.size() ? "" : ".." + std::to_string(max.size())),
          number_or_dash(statistics.mean, distance_decimals),
          number_or_dash(statistics.deviation, distance_decimals),
          fixed_text(distance, distance_decimals),
          gain_text(distance, reference_m),
          shown_value(experiment, method, *best.front())};
}

/// The row of a judged method with its results in the engine of the search.
Row search_row(const MethodRuns& method) {
  const std::vector<const Evaluation*> best = best_of_searches(method);
  const Statistics statistics = statistics_of(best);
  return {"  in the search",
          "",
          "",
          number_or_dash(statistics.mean, distance_decimals),
          number_or_dash(statistics.deviation, distance_decimals),
          best.empty() ? "-" : fixed_text(best.front()->scores.front(), distance_decimals),
          "",
          ""};
}

Row thesis_row(const ThesisExperiment& experiment, const ThesisResult& result) {
  const double reference_m = experiment.references.front().thesis_m;
  return {
      "  the thesis",
      std::to_string(result.runs),
      "",
      "",
      "",
      fixed_text(result.displacements_m.front(), distance_decimals),
      reference_m > 0.0 ? gain_text(result.displacements_m.front(), reference_m) : "",
      plain_number(result.rows.at(experiment.shown_row).values.front(), 2) + " " + std::string(experiment.shown_unit)};
}

std::string difference_text(const MethodDifference& difference) {
  constexpr double significance = 0.05;
  const bool is_first = difference.share_above >= 0.5;
  const double share = is_first ? difference.share_above : 1.0 - difference.share_above;
  std::array<char, 16> p_value{};
  std::snprintf(p_value.data(), p_value.size(), "%.2g", difference.p_value);
  return (is_first ? difference.one : difference.other) + " goes farther than " +
         (is_first ? difference.other : difference.one) + " in " + fixed_text(100.0 * share, 0) +
         " % of the pairs of runs, p = " + p_value.data() + ": " +
         (difference.p_value < significance ? "they differ" : "no difference is shown") + "\n";
}

const MethodRuns* find_method(std::span<const MethodRuns> methods, std::string_view name) {
  const auto found = std::ranges::find(methods, name, &MethodRuns::method);
  return found == methods.end() ? nullptr : &*found;
}

std::string overtaking_text(const ThesisExperiment& experiment, const BestCurves& deluge, const BestCurves& genetic) {
  const std::string subject = "great deluge's mean ";
  const std::string thesis = " (the thesis: at around " + std::string(experiment.overtaking) + ")\n";
  const std::optional<std::size_t> evaluation = overtaking(deluge, genetic);
  if (!evaluation) {
    return subject + "does not overtake the genetic algorithm's" + thesis;
  }
  return subject +
         (*evaluation == 0 ? "is above the genetic algorithm's from the start"
                           : "stays above the genetic algorithm's after evaluation " + std::to_string(*evaluation)) +
         thesis;
}

/// Text with the number of evaluations after which a method reaches the final mean of great deluge.
std::string reach_text(const MethodRuns& method, const MethodRuns& deluge, const BestCurves& deluge_curves) {
  const double goal = deluge_curves.mean.back();
  double evaluations = 0.0;
  double runs = 0.0;
  for (const std::vector<Evaluation>& run : deluge.runs) {
    evaluations += static_cast<double>(run.size());
    runs += run.empty() ? 0.0 : 1.0;
  }
  const double mean_evaluations = evaluations / runs;
  const std::optional<std::size_t> reached = evaluations_to_reach(best_curves(method), goal);
  const std::string goal_text = "great deluge's final mean (" + fixed_text(goal, distance_decimals) + " m)";
  if (!reached) {
    return method.method + "'s mean does not reach " + goal_text + "\n";
  }
  return method.method + "'s mean reaches " + goal_text + " after " + std::to_string(*reached) +
         " evaluations: " + plain_number(100.0 * static_cast<double>(*reached) / mean_evaluations, 1) +
         " % of great deluge's " + plain_number(mean_evaluations, 0) + "\n";
}

}  // namespace

std::string experiment_table(const ThesisExperiment& experiment, const MethodRuns& method) {
  std::string table = "source\tvalue";
  for (std::size_t column = 1; column <= thesis_columns; ++column) {
    table += "\t" + std::to_string(column);
  }
  table += "\n";

  std::vector<const Evaluation*> best = best_of_runs(method);
  best.resize(std::min(best.size(), thesis_columns));
  const auto add_row = [&](const std::string& label, const auto& cell) {
    table += "here\t" + label;
    for (std::size_t column = 0; column < thesis_columns; ++column) {
      table += "\t" + (column < best.size() ? cell(*best[column]) : std::string());
    }
    table += "\n";
  };
  for (const ThesisRow& row : experiment.rows(method.space)) {
    add_row(row.name,
            [&](const Evaluation& evaluation) { return method.space.value_text(evaluation.candidate, row.dimension); });
  }
  add_row(std::string(thesis_distance_row),
          [](const Evaluation& evaluation) { return fixed_text(evaluation.scores.front(), distance_decimals); });

  if (const ThesisResult* thesis = find_thesis_result(experiment.name, method.method)) {
    const std::string source = "thesis, " + std::string(thesis->table);
    for (const ThesisResult::Row& row : thesis->rows) {
      table += source + "\t" + row.name;
      for (const double value : row.values) {
        table += "\t" + plain_number(value, 2);
      }
      table += "\n";
    }
    table += source + "\t" + std::string(thesis_distance_row);
    for (const double displacement : thesis->displacements_m) {
      table += "\t" + fixed_text(displacement, distance_decimals);
    }
    table += "\n";
  }
  return table;
}

std::string experiment_summary(const ThesisExperiment& experiment, std::span<const MethodRuns> methods,
                               std::span<const Reference> references) {
  std::string text;
  for (const Reference& reference : references) {
    text += std::string(reference.scenario->name) + ": " + fixed_text(reference.judged_m, distance_decimals) + " m";
    if (reference.scenario->thesis_m > 0.0) {
      text += " (the thesis: " + fixed_text(reference.scenario->thesis_m, 2) + " m)";
    }
    text += "\n";
  }
  const double reference_m = references.empty() ? NAN : references.front().judged_m;
  text += "\n" + row_text({"method", "runs", "evaluations", "mean (m)", "sd (m)", "best (m)", "gain",
                           std::string(experiment.shown_value)});
  for (const MethodRuns& method : methods) {
    text += row_text(method_row(experiment, method, reference_m));
    if (!method.judged.empty()) {
      text += row_text(search_row(method));
    }
    if (const ThesisResult* thesis = find_thesis_result(experiment.name, method.method)) {
      text += row_text(thesis_row(experiment, *thesis));
    }
  }
  text += "\nmean and sd (standard deviation) are over the best of each run; gain and " +
          std::string(experiment.shown_value) + " are those of the best run\n";
  if (const std::vector<MethodDifference> differences = method_differences(methods); !differences.empty()) {
    text += "\ndifferences (rank-sum test of the best of each run, corrected after Holm):\n";
    for (const MethodDifference& difference : differences) {
      text += difference_text(difference);
    }
    text += "\n";
  }

  const MethodRuns* const deluge = find_method(methods, "great-deluge");
  const BestCurves deluge_curves = deluge != nullptr ? best_curves(*deluge) : BestCurves();
  if (deluge_curves.mean.empty()) {
    return text;
  }
  if (const MethodRuns* const genetic = find_method(methods, "genetic")) {
    if (const BestCurves curves = best_curves(*genetic); !curves.mean.empty()) {
      text += overtaking_text(experiment, deluge_curves, curves);
    }
  }
  for (const MethodRuns& method : methods) {
    const bool has_runs = std::ranges::any_of(method.runs, [](const auto& run) { return !run.empty(); });
    if (&method != deluge && has_runs) {
      text += reach_text(method, *deluge, deluge_curves);
    }
  }
  return text;
}

std::vector<MethodDifference> method_differences(std::span<const MethodRuns> methods) {
  std::vector<std::vector<double>> distances;
  std::vector<const MethodRuns*> with_runs;
  for (const MethodRuns& method : methods) {
    std::vector<double> of_method;
    for (const Evaluation* evaluation : best_of_runs(method)) {
      of_method.push_back(evaluation->scores.front());
    }
    if (!of_method.empty()) {
      distances.push_back(std::move(of_method));
      with_runs.push_back(&method);
    }
  }
  std::vector<MethodDifference> differences;
  std::vector<double> p_values;
  for (std::size_t i = 0; i < with_runs.size(); ++i) {
    for (std::size_t j = i + 1; j < with_runs.size(); ++j) {
      differences.push_back({with_runs[i]->method, with_runs[j]->method, share_above(distances[i], distances[j]), 1.0});
      p_values.push_back(rank_sum_test(distances[i], distances[j]));
    }
  }
  const std::vector<double> corrected = correct_for_several(p_values);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    differences[i].p_value = corrected[i];
  }
  return differences;
}

}  // namespace proleg::optimize
