#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {
namespace {

using sim::Axis;
using sim::Point;
using sim::Polyline;
using sim::Svg;
using sim::TextAnchor;

constexpr double panel_bottom = 470.0;
constexpr double page_height = panel_bottom + 56.0;

/// SVG attributes of the dots, which are larger if there are fewer of them.
std::string dot_style(std::size_t evaluations) {
  const double size = evaluations <= 300 ? 5.0 : evaluations <= 3000 ? 3.4 : 2.4;
  return R"(stroke="#8fb3c9" stroke-linecap="round" stroke-width=")" + sim::plain_number(size, 1) + "\"";
}
constexpr const char* cross_style = R"(stroke="#e69f00" stroke-width="1.1")";
constexpr const char* failure_style = R"(stroke="#d55e00" stroke-width="1.1")";
constexpr const char* best_style = R"(stroke="#0072b2" stroke-width="2.4" stroke-linejoin="round")";
constexpr const char* mean_style = R"(stroke="#222222" stroke-width="1.1" stroke-linejoin="round")";
constexpr const char* baseline_style = R"(stroke="#009e73" stroke-width="1.3" stroke-dasharray="7 4")";
constexpr const char* restart_style = R"(stroke="#888888" stroke-width="1" stroke-dasharray="2 3")";
constexpr const char* dot = "h0";
constexpr const char* cross = "m-2 -2l4 4m0 -4l-4 4";
constexpr const char* failure_mark = "v-7";

/// Contents of the figure. x: number of the evaluation, from 1; y: score.
struct Contents {
  Polyline rated;
  Polyline given_up;
  std::vector<double> restarts;  ///< numbers of the evaluations that began one
  std::vector<double> failed;    ///< numbers of evaluations that have no score of measures
  Polyline best;                 ///< a step for each improvement
  std::optional<Point> winner;
  Polyline mean;  ///< mean of the last `window` scores
  std::size_t window = 1;
  std::optional<double> baseline;
};

void add_to_best(const Objective& objective, Point rated, Contents& contents) {
  if (!contents.winner || objective.better(rated.y, contents.winner->y)) {
    if (contents.winner) {
      contents.best.push_back({rated.x, contents.winner->y});
    }
    contents.best.push_back(rated);
    contents.winner = rated;
  }
}

/// The mean of the latest scores shows the present state of the search; the mean of all would hide it.
Polyline moving_mean(const Polyline& scores, std::size_t window) {
  Polyline mean;
  double sum = 0.0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    sum += scores[i].y;
    if (i >= window) {
      sum -= scores[i - window].y;
    }
    mean.push_back({scores[i].x, sum / static_cast<double>(std::min(i + 1, window))});
  }
  return mean;
}

Contents collect(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  Contents contents;
  Polyline with_score;
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    const Evaluation& evaluation = evaluations[i];
    const auto number = static_cast<double>(i + 1);
    if (evaluation.after_restart) {
      contents.restarts.push_back(number);
    }
    if (!has_own_score(experiment, evaluation, 0)) {
      contents.failed.push_back(number);
      continue;
    }
    const Point point{number, drawable(evaluation.scores.front())};
    with_score.push_back(point);
    (evaluation.given_up ? contents.given_up : contents.rated).push_back(point);
    if (!evaluation.given_up) {
      add_to_best(experiment.objectives.front(), point, contents);
    }
  }
  if (contents.winner) {
    contents.best.push_back({static_cast<double>(evaluations.size()), contents.winner->y});
  }
  if (const Evaluation* const baseline = baseline_of(experiment, evaluations);
      baseline != nullptr && has_own_score(experiment, *baseline, 0)) {
    contents.baseline = drawable(baseline->scores.front());
  }
  contents.window = std::max<std::size_t>(20, evaluations.size() / 50);
  contents.mean = moving_mean(with_score, contents.window);
  return contents;
}

Axis axis_of(const Contents& contents) {
  std::vector<double> scores;
  for (const Polyline* trace : {&contents.rated, &contents.given_up}) {
    for (const Point& point : *trace) {
      scores.push_back(point.y);
    }
  }
  // The best of the first evaluations may be far off; the best of ten is not.
  constexpr double settled = 10.0;
  std::vector<double> best;
  for (const Point& point : contents.best) {
    if (point.x > settled) {
      best.push_back(point.y);
    }
  }
  if (contents.baseline) {
    best.push_back(*contents.baseline);
  }
  return score_axis(std::move(scores), best, panel_bottom, sim::first_panel_top);
}

std::string count_text(double evaluations) {
  return sim::plain_number(evaluations, 0) + (evaluations == 1.0 ? " evaluation" : " evaluations");
}

/// ", 2 restarts"; empty for none.
std::string count_of(std::size_t count, const char* what) {
  return count == 0 ? "" : ", " + std::to_string(count) + what + (count == 1 ? "" : "s");
}

void draw_head(Svg& svg, const Experiment& experiment, const Contents& contents, std::size_t evaluations) {
  sim::draw_title(svg, shortened(experiment.title()),
                  "method " + method_name(experiment.method) + ", " + count_text(static_cast<double>(evaluations)) +
                      count_of(contents.restarts.size(), " restart") +
                      (contents.failed.empty() ? "" : ", " + std::to_string(contents.failed.size()) + " failed"));
  if (contents.winner) {
    const std::string_view unit = experiment.objectives.front().unit();
    svg.text({sim::page_right, sim::subtitle_y},
             "best " + rounded_text(contents.winner->y, unit) + " after " + count_text(contents.winner->x),
             TextAnchor::end, sim::label_size, sim::ink, R"(font-weight="bold")");
  }
}

void draw_key(Svg& svg, const Contents& contents) {
  std::vector<sim::LegendEntry> entries{{"evaluation", dot_style(0), dot}};
  if (!contents.given_up.empty()) {
    entries.push_back({"given up", cross_style, cross});
  }
  if (!contents.failed.empty()) {
    entries.push_back({"failed", failure_style, "m0 3.5" + std::string(failure_mark)});
  }
  entries.push_back({"mean of " + std::to_string(contents.window), mean_style, ""});
  entries.push_back({"best so far", best_style, ""});
  if (!contents.restarts.empty()) {
    entries.push_back({"restart", restart_style, "m0 6v-12"});
  }
  if (contents.baseline) {
    entries.push_back({"baseline " + rounded_text(*contents.baseline), baseline_style, ""});
  }
  sim::draw_legend(svg, sim::page_right, sim::first_panel_top - 16.0, entries);
}

}  // namespace

std::string draw_learning_curve(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  const Contents contents = collect(experiment, evaluations);
  const Objective& objective = experiment.objectives.front();
  const auto last = static_cast<double>(std::max<std::size_t>(evaluations.size(), 10));
  const Axis x{0.0, last, sim::page_left, sim::page_right};
  const Axis y = axis_of(contents);

  Svg svg(sim::page_width, page_height, experiment.title(),
          "Scores of the evaluations of an optimisation, the best so far and the mean, against their number.");
  draw_head(svg, experiment, contents, evaluations.size());
  draw_key(svg, contents);
  sim::draw_plot_grid(svg, x, y, "evaluations", with_unit(shortened(objective.name), objective.unit()));
  svg.begin_group("restarts");
  for (const double number : contents.restarts) {
    svg.polyline(sim::to_pixels({{number, y.low}, {number, y.high}}, x, y), restart_style);
  }
  svg.end_group();
  svg.begin_group("evaluations");
  svg.marks(sim::to_marks(contents.rated, x, y, 2.5), dot, dot_style(evaluations.size()));
  svg.end_group();
  svg.begin_group("given up");
  svg.marks(sim::to_marks(contents.given_up, x, y, 6.0), cross, cross_style);
  svg.end_group();
  svg.begin_group("failed");
  Polyline failed;
  for (const double number : contents.failed) {
    failed.push_back({number, y.low});
  }
  svg.marks(sim::to_marks(failed, x, y, 1.0), failure_mark, failure_style);
  svg.end_group();
  svg.begin_group("mean");
  svg.polyline(sim::to_pixels(contents.mean, x, y), mean_style);
  svg.end_group();
  svg.begin_group("baseline");
  if (contents.baseline) {
    svg.polyline(sim::to_pixels({{0.0, *contents.baseline}, {last, *contents.baseline}}, x, y), baseline_style);
  }
  svg.end_group();
  svg.begin_group("best");
  svg.polyline(sim::to_pixels(contents.best, x, y), best_style);
  if (contents.winner) {
    svg.circle(sim::to_pixels({*contents.winner}, x, y).front(), 4.0, R"(fill="#0072b2")");
  }
  svg.end_group();
  sim::draw_plot_frame(svg, x, y);
  const auto beyond =
      std::ranges::count_if(contents.rated, [&](const Point& point) { return point.y < y.low || point.y > y.high; });
  if (beyond > 0) {
    svg.text({sim::page_right, panel_bottom + 37.0}, std::to_string(beyond) + " outside the axis, drawn at the edge",
             TextAnchor::end, sim::label_size, sim::faint_ink);
  }
  return svg.finish();
}

}  // namespace proleg::optimize
