#include "sim/optimize/report/report.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {
namespace {

/// Whether scores a are better than b in one objective and worse in none.
bool dominates(const Experiment& experiment, const std::vector<double>& a, const std::vector<double>& b) {
  bool better = false;
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    const Objective& objective = experiment.objectives[i];
    if (objective.better(b[i], a[i])) {
      return false;
    }
    better = better || objective.better(a[i], b[i]);
  }
  return better;
}

/// Orders scores, best first: by the first objective, then by the second, and so on. A candidate comes before those
/// that it dominates.
bool comes_before(const Experiment& experiment, const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    if (a[i] != b[i]) {
      return experiment.objectives[i].better(a[i], b[i]);
    }
  }
  return false;
}

bool has_all_scores(const Experiment& experiment, const Evaluation& evaluation) {
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    if (!has_own_score(experiment, evaluation, i)) {
      return false;
    }
  }
  return true;
}

using sim::Polyline;
using sim::Svg;

constexpr double pareto_bottom = 540.0;
constexpr double pareto_page_height = pareto_bottom + 56.0;

constexpr const char* pareto_dot_style = R"(stroke="#8fb3c9" stroke-width="3" stroke-linecap="round")";
constexpr const char* front_style = R"(stroke="#0072b2" stroke-width="1.6" stroke-linejoin="round")";
constexpr const char* front_dot_style = R"(stroke="#0072b2" stroke-width="7" stroke-linecap="round")";
constexpr const char* pareto_dot = "h0";

/// The first two scores of each evaluation that has both.
struct Cloud {
  Polyline places;
  std::vector<double> x;
  std::vector<double> y;

  void add(const Experiment& experiment, const Evaluation& evaluation) {
    if (experiment.objectives.size() >= 2 && has_own_score(experiment, evaluation, 0) &&
        has_own_score(experiment, evaluation, 1)) {
      x.push_back(drawable(evaluation.scores[0]));
      y.push_back(drawable(evaluation.scores[1]));
      places.push_back({x.back(), y.back()});
    }
  }
};

std::string axis_name(const Experiment& experiment, std::size_t objective) {
  if (objective >= experiment.objectives.size()) {
    return {};
  }
  const Objective& named = experiment.objectives[objective];
  return with_unit(shortened(named.name), named.unit()) +
         (named.goal == Goal::maximise ? ": more is better" : ": less is better");
}

}  // namespace

std::vector<std::size_t> pareto_front(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  std::vector<std::size_t> order(evaluations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !has_all_scores(experiment, evaluations[i]); });
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return comes_before(experiment, evaluations[a].scores, evaluations[b].scores);
  });

  std::vector<std::size_t> front;
  std::set<Candidate> same_scores;  // candidates with the scores of the last one on the front
  for (const std::size_t i : order) {
    const std::vector<double>& scores = evaluations[i].scores;
    // With two objectives, the last one on the front is the best so far in the second: only it can dominate.
    const std::size_t rivals =
        experiment.objectives.size() <= 2 ? std::min<std::size_t>(front.size(), 1) : front.size();
    const bool beaten = std::any_of(front.end() - static_cast<std::ptrdiff_t>(rivals), front.end(), [&](std::size_t j) {
      return dominates(experiment, evaluations[j].scores, scores);
    });
    if (beaten) {
      continue;
    }
    if (front.empty() || evaluations[front.back()].scores != scores) {
      same_scores.clear();
    }
    if (same_scores.insert(evaluations[i].candidate).second) {
      front.push_back(i);
    }
  }

  const auto is_less = [&](std::size_t a, std::size_t b) {
    const double first = evaluations[a].scores.front();
    const double second = evaluations[b].scores.front();
    return first != second ? first < second : a < b;
  };
  std::ranges::sort(front, is_less);
  return front;
}

std::string draw_pareto_front(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  const std::vector<std::size_t> front = pareto_front(experiment, evaluations);
  Cloud all;
  Cloud best;
  for (const Evaluation& evaluation : evaluations) {
    all.add(experiment, evaluation);
  }
  for (const std::size_t i : front) {
    best.add(experiment, evaluations[i]);
  }
  const sim::Axis x = score_axis(std::move(all.x), best.x, sim::page_left, sim::page_right);
  const sim::Axis y = score_axis(std::move(all.y), best.y, pareto_bottom, sim::first_panel_top);

  Svg svg(sim::page_width, pareto_page_height, experiment.title(),
          "Candidates by two objectives; a line joins those that no other dominates.");
  sim::draw_title(svg, shortened(experiment.title()),
                  "method " + method_name(experiment.method) + ", " + std::to_string(evaluations.size()) +
                      " evaluations, " + std::to_string(front.size()) + " of them on the Pareto front");
  const std::array<sim::LegendEntry, 2> entries{
      {{"evaluation", pareto_dot_style, pareto_dot}, {"Pareto front", front_dot_style, pareto_dot}}};
  sim::draw_legend(svg, sim::page_right, sim::first_panel_top - 16.0, entries);
  sim::draw_plot_grid(svg, x, y, axis_name(experiment, 0), axis_name(experiment, 1));
  svg.begin_group("evaluations");
  svg.marks(sim::to_marks(all.places, x, y, 2.5), pareto_dot, pareto_dot_style);
  svg.end_group();
  svg.begin_group("front");
  if (experiment.objectives.size() == 2) {  // with more objectives the front is not a line
    svg.polyline(sim::to_pixels(best.places, x, y), front_style);
  }
  svg.marks(sim::to_marks(best.places, x, y, 2.5), pareto_dot, front_dot_style);
  svg.end_group();
  sim::draw_plot_frame(svg, x, y);
  return svg.finish();
}

}  // namespace proleg::optimize
