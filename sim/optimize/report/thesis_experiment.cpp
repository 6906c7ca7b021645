#include "sim/optimize/report/thesis_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/optimize/report/scores.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {
namespace {

using sim::plain_number;

constexpr std::array<ThesisResult, 2> published{{
    {"great-deluge",
     "table 6.2",
     30,
     {{{40, 40, 40, 40, 40, 40, 40, 40, 40, 40},
       {40, 39.5, 39.75, 40, 40, 40, 40, 40, 40, 40},
       {39.75, 40, 40, 40, 40, 40, 39.75, 40, 40, 39.75},
       {40, 39.75, 40, 40, 40, 40, 40, 40, 40, 40},
       {0, 0, 0, 0.75, 0, 0, 0, 0, 1.5, 0}}},
     {1.958, 1.956, 1.954, 1.953, 1.950, 1.949, 1.949, 1.947, 1.946, 1.945}},
    {"genetic",
     "table 6.4",
     29,
     {{{37.5, 39.5, 38.75, 39.75, 39.25, 37, 38.25, 39.75, 37.75, 38.75},
       {39.25, 40, 40, 38.75, 39.5, 39.5, 38.75, 39, 38.5, 39.75},
       {39.25, 39, 38, 40, 39.75, 39.25, 40, 40, 40, 40},
       {39.5, 39.25, 38.25, 37.25, 39.25, 38.75, 39.75, 36.75, 39.5, 30.25},
       {1, 2.25, 0.5, 0.5, 0.75, 2.25, 0, 0.75, 3.25, 0.75}}},
     {1.878, 1.874, 1.865, 1.846, 1.839, 1.828, 1.822, 1.820, 1.816, 1.806}},
}};

constexpr std::size_t columns = 10;
constexpr int distance_decimals = 3;

/// The best evaluation of each repetition that has any, best first.
std::vector<const Evaluation*> best_of_runs(const MethodRuns& method) {
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

/// Dimensions from head to tail: by the first joint that each sets.
std::vector<std::size_t> dimensions_head_to_tail(const SearchSpace& space) {
  std::vector<std::size_t> order(space.dimensions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return space.dimensions[i].targets.front().joint; });
  return order;
}

/// Text padded with blanks: to the left edge, or (width below 0) to the right one.
std::string padded(std::string text, int width) {
  const auto size = static_cast<std::size_t>(std::abs(width));
  if (text.size() < size) {
    text.insert(width < 0 ? 0 : text.size(), size - text.size(), ' ');
  }
  return text;
}

struct Statistics {
  double mean = NAN;
  double deviation = NAN;  ///< sample standard deviation; not a number for less than two
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
  constexpr std::array<int, 8> widths{14, -6, -14, -12, -9, -9, -11, -14};
  std::string text;
  for (std::size_t i = 0; i < row.size(); ++i) {
    text += padded(row[i], widths[i]);
  }
  return text + "\n";
}

Row method_row(const MethodRuns& method, double uniform_m) {
  const std::vector<const Evaluation*> best = best_of_runs(method);
  if (best.empty()) {
    return {method.method, "0", "-", "-", "-", "-", "-", "-"};
  }
  const auto [fewest, most] = std::ranges::minmax(method.runs, {}, &std::vector<Evaluation>::size);
  const Statistics statistics = statistics_of(best);
  const double distance = best.front()->scores.front();
  const std::vector<std::size_t> order = dimensions_head_to_tail(method.space);
  return {method.method,
          std::to_string(best.size()),
          std::to_string(fewest.size()) + (fewest.size() == most.size() ? "" : ".." + std::to_string(most.size())),
          number_or_dash(statistics.mean, distance_decimals),
          number_or_dash(statistics.deviation, distance_decimals),
          fixed_text(distance, distance_decimals),
          gain_text(distance, uniform_m),
          order.empty() ? "-" : method.space.value_text(best.front()->candidate, order.back()) + " deg"};
}

Row thesis_row(const ThesisResult& result) {
  return {"  the thesis",
          std::to_string(result.runs),
          "",
          "",
          "",
          fixed_text(result.displacements_m.front(), distance_decimals),
          gain_text(result.displacements_m.front(), thesis_uniform_distance_m),
          plain_number(result.amplitudes_deg.back().front(), 2) + " deg"};
}

const MethodRuns* find_method(std::span<const MethodRuns> methods, std::string_view name) {
  const auto found = std::ranges::find(methods, name, &MethodRuns::method);
  return found == methods.end() ? nullptr : &*found;
}

std::string overtaking_text(const BestCurves& deluge, const BestCurves& genetic) {
  const std::string who = "great deluge's mean ";
  const std::string thesis = " (the thesis: at around 5000)\n";
  const std::optional<std::size_t> evaluation = overtaking(deluge, genetic);
  if (!evaluation) {
    return who + "does not overtake the genetic algorithm's" + thesis;
  }
  return who +
         (*evaluation == 0 ? "is above the genetic algorithm's from the start"
                           : "stays above the genetic algorithm's after evaluation " + std::to_string(*evaluation)) +
         thesis;
}

/// How soon a method reaches the mean that great deluge ends with.
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

std::span<const ThesisResult, 2> thesis_results() { return published; }

const ThesisResult* find_thesis_result(std::string_view method) {
  const auto result = std::ranges::find(published, method, &ThesisResult::method);
  return result == published.end() ? nullptr : &*result;
}

std::vector<double> best_so_far(std::span<const Evaluation> run) {
  std::vector<double> best;
  best.reserve(run.size());
  for (const Evaluation& evaluation : run) {
    const double score = evaluation.scores.front();
    best.push_back(best.empty() ? score : std::max(best.back(), score));
  }
  return best;
}

BestCurves best_curves(const MethodRuns& method) {
  std::vector<std::vector<double>> runs;
  std::size_t longest = 0;
  for (const std::vector<Evaluation>& run : method.runs) {
    if (!run.empty()) {
      runs.push_back(best_so_far(run));
      longest = std::max(longest, run.size());
    }
  }
  BestCurves curves;
  for (std::size_t i = 0; i < longest; ++i) {
    double sum = 0.0;
    double low = INFINITY;
    double high = -INFINITY;
    for (const std::vector<double>& run : runs) {
      const double best = run[std::min(i, run.size() - 1)];
      sum += best;
      low = std::min(low, best);
      high = std::max(high, best);
    }
    curves.lowest.push_back(low);
    curves.mean.push_back(sum / static_cast<double>(runs.size()));
    curves.highest.push_back(high);
  }
  return curves;
}

std::string experiment_table(const MethodRuns& method) {
  std::string table = "source\tvalue";
  for (std::size_t column = 1; column <= columns; ++column) {
    table += "\t" + std::to_string(column);
  }
  table += "\n";

  std::vector<const Evaluation*> best = best_of_runs(method);
  best.resize(std::min(best.size(), columns));
  const auto add_row = [&](const std::string& label, const auto& cell) {
    table += "here\t" + label;
    for (std::size_t column = 0; column < columns; ++column) {
      table += "\t" + (column < best.size() ? cell(*best[column]) : std::string());
    }
    table += "\n";
  };
  std::size_t joint = 0;
  for (const std::size_t i : dimensions_head_to_tail(method.space)) {
    add_row("Joint " + std::to_string(joint++),
            [&](const Evaluation& evaluation) { return method.space.value_text(evaluation.candidate, i); });
  }
  add_row("Displacement [m]",
          [](const Evaluation& evaluation) { return fixed_text(evaluation.scores.front(), distance_decimals); });

  if (const ThesisResult* thesis = find_thesis_result(method.method)) {
    const std::string source = "thesis, " + std::string(thesis->table);
    for (std::size_t j = 0; j < thesis->amplitudes_deg.size(); ++j) {
      table += source + "\tJoint " + std::to_string(j);
      for (const double amplitude : thesis->amplitudes_deg[j]) {
        table += "\t" + plain_number(amplitude, 2);
      }
      table += "\n";
    }
    table += source + "\tDisplacement [m]";
    for (const double displacement : thesis->displacements_m) {
      table += "\t" + fixed_text(displacement, distance_decimals);
    }
    table += "\n";
  }
  return table;
}

std::optional<std::size_t> overtaking(const BestCurves& follower, const BestCurves& leader) {
  const std::size_t length = std::max(follower.mean.size(), leader.mean.size());
  if (follower.mean.empty() || leader.mean.empty()) {
    return std::nullopt;
  }
  const auto at = [](const std::vector<double>& curve, std::size_t i) { return curve[std::min(i, curve.size() - 1)]; };
  std::size_t above_from = length;
  while (above_from > 0 && at(follower.mean, above_from - 1) > at(leader.mean, above_from - 1)) {
    --above_from;
  }
  return above_from == length ? std::nullopt : std::optional(above_from);
}

std::optional<std::size_t> evaluations_to_reach(const BestCurves& curves, double score) {
  const auto reached = std::ranges::find_if(curves.mean, [score](double mean) { return mean >= score; });
  return reached == curves.mean.end() ? std::nullopt
                                      : std::optional(static_cast<std::size_t>(reached - curves.mean.begin()) + 1);
}

std::string experiment_summary(std::span<const MethodRuns> methods, double uniform_m) {
  std::string text = "uniform amplitudes of 40 deg: " + fixed_text(uniform_m, distance_decimals) +
                     " m (the thesis: " + fixed_text(thesis_uniform_distance_m, 2) + " m)\n\n";
  text += row_text({"method", "runs", "evaluations", "mean (m)", "sd (m)", "best (m)", "gain", "tail joint"});
  for (const MethodRuns& method : methods) {
    text += row_text(method_row(method, uniform_m));
    if (const ThesisResult* thesis = find_thesis_result(method.method)) {
      text += row_text(thesis_row(*thesis));
    }
  }
  text += "\nmean and standard deviation are over the bests of the runs, gain and tail joint those of the best run\n";

  const MethodRuns* const deluge = find_method(methods, "great-deluge");
  const BestCurves deluge_curves = deluge != nullptr ? best_curves(*deluge) : BestCurves();
  if (deluge_curves.mean.empty()) {
    return text;
  }
  if (const MethodRuns* const genetic = find_method(methods, "genetic")) {
    if (const BestCurves curves = best_curves(*genetic); !curves.mean.empty()) {
      text += overtaking_text(deluge_curves, curves);
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

}  // namespace proleg::optimize
