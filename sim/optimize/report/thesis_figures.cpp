#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/report/method_runs.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/optimize/report/thesis_data.hpp"
#include "sim/optimize/report/thesis_experiment.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {
namespace {

using sim::Axis;
using sim::LegendEntry;
using sim::LineName;
using sim::Polyline;
using sim::Svg;

constexpr double plot_right = 740.0;  ///< the names of lines stand to the right of it

constexpr const char* dotted = "1.5 3.5";
constexpr const char* dashed = "7 4";

/// A score for comparison, drawn from edge to edge.
struct Level {
  double value;
  std::string text;
  std::string colour;
  const char* dashes;
};

/// The axes of a panel that shows the best scores so far against evaluations.
struct CurvePanel {
  sim::Axis x;
  sim::Axis y;
};

/// The best so far as a line of steps.
Polyline steps(const std::vector<double>& best) {
  Polyline trace;
  for (std::size_t i = 0; i < best.size(); ++i) {
    const bool changes = i == 0 || best[i] != best[i - 1];
    if (i > 0 && changes) {
      trace.push_back({static_cast<double>(i + 1), drawable(best[i - 1])});
    }
    if (changes || i + 1 == best.size()) {
      trace.push_back({static_cast<double>(i + 1), drawable(best[i])});
    }
  }
  return trace;
}

/// SVG attributes of a line.
std::string line_style(const std::string& colour, double width, const std::string& dashes = {}) {
  return "stroke=\"" + colour + "\" stroke-width=\"" + sim::plain_number(width, 2) + "\" stroke-linejoin=\"round\"" +
         (dashes.empty() ? "" : " stroke-dasharray=\"" + dashes + "\"");
}

/// Makes a panel in which all curves and levels fit.
CurvePanel make_panel(double top, double height, std::span<const BestCurves> curves, std::span<const Level> levels) {
  std::size_t max_evaluations = 10;
  double low = INFINITY;
  double high = -INFINITY;
  const auto include = [&](double value) {
    if (std::isfinite(value)) {
      low = std::min(low, drawable(value));
      high = std::max(high, drawable(value));
    }
  };
  for (const BestCurves& curve : curves) {
    max_evaluations = std::max(max_evaluations, curve.mean.size());
    if (!curve.mean.empty()) {
      include(curve.min.front());
      include(curve.max.back());
    }
  }
  for (const Level& level : levels) {
    include(level.value);
  }
  return {{0.0, static_cast<double>(max_evaluations), sim::page_left, plot_right},
          low <= high ? sim::axis_over(low, high, top + height, top) : Axis{0.0, 1.0, top + height, top}};
}

void draw_levels(Svg& svg, const CurvePanel& panel, std::span<const Level> levels) {
  svg.begin_group("levels");
  for (const Level& level : levels) {
    if (std::isfinite(level.value)) {
      const double at = panel.y.pixel(drawable(level.value));
      svg.line({panel.x.pixel_low, at}, {panel.x.pixel_high, at}, line_style(level.colour, 1.3, level.dashes));
    }
  }
  svg.end_group();
}

/// Draws one curve as steps. style: from line_style().
void draw_curve(Svg& svg, const CurvePanel& panel, const std::vector<double>& best, const std::string& style) {
  svg.polyline(sim::to_pixels(steps(best), panel.x, panel.y), style);
}

/// Draws the best so far of each repetition.
void draw_every_curve(Svg& svg, const CurvePanel& panel, const MethodRuns& method, const std::string& colour) {
  svg.begin_group("run");
  for (const std::vector<Evaluation>& run : method.runs) {
    draw_curve(svg, panel, best_so_far(run), line_style(colour, 1.1) + R"( stroke-opacity="0.65")");
  }
  svg.end_group();
}

/// Draws the names of levels and curves at the right edge.
void draw_names(Svg& svg, const CurvePanel& panel, std::span<const Level> levels, std::vector<LineName> names) {
  for (const Level& level : levels) {
    if (std::isfinite(level.value)) {
      names.push_back({level.value, level.text, level.colour});
    }
  }
  sim::draw_line_names(svg, panel.y, plot_right, names);
}

constexpr double single_panel_height = 380.0;
constexpr double double_panel_height = 320.0;
constexpr double between_panels = 96.0;

/// Colours of methods. Great deluge is green and the genetic algorithm red, as in the thesis. Colour-blind people can
/// distinguish this green and red.
class Palette {
 public:
  std::string next(std::string_view method) {
    if (method == "great-deluge") {
      return "#009e73";
    }
    if (method == "genetic") {
      return "#d55e00";
    }
    constexpr std::array<const char*, 4> others{"#0072b2", "#cc79a7", "#e69f00", "#56b4e9"};
    return others[used_++ % others.size()];
  }

 private:
  std::size_t used_ = 0;
};

std::string title_of(std::string_view method) {
  if (method == "great-deluge") {
    return "Great deluge";
  }
  if (method == "great-deluge-bounded") {
    return "Great deluge, bounded";
  }
  return method == "genetic" ? "Genetic algorithm" : std::string(method);
}

std::vector<Level> reference_levels(std::span<const Reference> references) {
  std::vector<Level> levels;
  for (const Reference& reference : references) {
    levels.push_back({reference.searched_m,
                      std::string(reference.scenario->short_name) + " " + rounded_text(reference.searched_m), "#000000",
                      dotted});
  }
  return levels;
}

/// A line across the picture at the best score of all runs of a method.
std::vector<Level> best_level(const BestCurves& curves, const std::string& colour) {
  if (curves.max.empty()) {
    return {};
  }
  return {{curves.max.back(), "best " + fixed_text(curves.max.back(), 3), colour, dotted}};
}

/// A line across the picture at the best score that the thesis has for a method.
std::vector<Level> thesis_level(const ThesisExperiment& experiment, const MethodRuns& method,
                                const std::string& colour) {
  const ThesisResult* const thesis = find_thesis_result(experiment.name, method.method);
  if (thesis == nullptr) {
    return {};
  }
  const double best = thesis->displacements_m.front();
  return {{best, "thesis " + fixed_text(best, 3), colour, dashed}};
}

std::string repetitions_text(const MethodRuns& method) {
  return std::to_string(method.runs.size()) + (method.runs.size() == 1 ? " repetition" : " repetitions");
}

/// A figure of one method; `draw` draws its curves and returns their names.
template <typename Draw>
std::string draw_method(const ThesisExperiment& experiment, const MethodRuns& method, const std::string& title,
                        const std::string& curves_text, const std::vector<Level>& levels, const BestCurves& curves,
                        const Draw& draw) {
  // Tables beside the figure have the distances of the judging engine.
  const std::string about =
      curves_text + (method.engine.empty() ? "" : ". Distances in the engine of the search, " + method.engine);
  const CurvePanel panel = make_panel(sim::first_panel_top, single_panel_height, {&curves, 1}, levels);
  Svg svg(sim::page_width, sim::first_panel_top + single_panel_height + 56.0, title, about);
  sim::draw_title(svg, title, about);
  std::vector<LegendEntry> legend{{"without a search", line_style(sim::ink, 1.3, dotted), ""}};
  if (find_thesis_result(experiment.name, method.method) != nullptr) {
    legend.push_back({"the thesis's best", line_style(sim::ink, 1.3, dashed), ""});
  }
  sim::draw_legend(svg, plot_right, sim::first_panel_top - 16.0, legend);
  sim::draw_plot_grid(svg, panel.x, panel.y, "evaluations", "Best distance so far (m)");
  draw_levels(svg, panel, levels);
  const std::vector<LineName> names = draw(svg, panel);
  sim::draw_plot_frame(svg, panel.x, panel.y);
  draw_names(svg, panel, levels, names);
  return svg.finish();
}

void append(std::vector<Level>& levels, const std::vector<Level>& more) {
  levels.insert(levels.end(), more.begin(), more.end());
}

}  // namespace

std::string draw_every_run(const ThesisExperiment& experiment, const MethodRuns& method,
                           std::span<const Reference> references) {
  const BestCurves curves = best_curves(method);
  const std::string colour = Palette().next(method.method);
  std::vector<Level> levels = thesis_level(experiment, method, colour);
  append(levels, reference_levels(references));
  return draw_method(experiment, method, title_of(method.method) + ": every run",
                     repetitions_text(method) + ", the best distance of each so far", levels, curves,
                     [&](Svg& svg, const CurvePanel& panel) {
                       draw_every_curve(svg, panel, method, colour);
                       std::vector<LineName> names;
                       for (const Level& best : best_level(curves, colour)) {
                         names.push_back({best.value, best.text, best.colour});
                       }
                       return names;
                     });
}

std::string draw_run_spread(const ThesisExperiment& experiment, const MethodRuns& method,
                            std::span<const Reference> references) {
  const BestCurves curves = best_curves(method);
  const std::string colour = Palette().next(method.method);
  std::vector<Level> levels = thesis_level(experiment, method, colour);
  append(levels, reference_levels(references));
  return draw_method(experiment, method, title_of(method.method) + ": lowest, mean and highest",
                     repetitions_text(method) + "; a repetition that has ended keeps its best", levels, curves,
                     [&](Svg& svg, const CurvePanel& panel) {
                       std::vector<LineName> names;
                       const auto draw = [&](const std::vector<double>& curve, double width, const std::string& name,
                                             const std::string& curve_colour) {
                         svg.begin_group(name);
                         draw_curve(svg, panel, curve, line_style(curve_colour, width));
                         svg.end_group();
                         if (!curve.empty()) {
                           names.push_back({curve.back(), name + " " + fixed_text(curve.back(), 3), curve_colour});
                         }
                       };
                       draw(curves.max, 1.3, "highest", sim::ink);
                       draw(curves.mean, 2.4, "mean", colour);
                       draw(curves.min, 1.3, "lowest", "#777777");
                       return names;
                     });
}

std::string draw_method_comparison(const ThesisExperiment& experiment, std::span<const MethodRuns> methods,
                                   std::span<const Reference> references) {
  Palette palette;
  std::vector<BestCurves> curves;
  std::vector<std::string> colours;
  std::vector<Level> best;    // levels named in (a)
  std::vector<Level> thesis;  // levels named in (b)
  std::vector<LineName> means;
  std::vector<LegendEntry> method_legend;
  for (const MethodRuns& method : methods) {
    const std::string colour = palette.next(method.method);
    colours.push_back(colour);
    curves.push_back(best_curves(method));
    append(best, best_level(curves.back(), colour));
    append(thesis, thesis_level(experiment, method, colour));
    method_legend.push_back({method.method, line_style(colour, 2.0), ""});
    if (!curves.back().mean.empty()) {
      const double mean = curves.back().mean.back();
      means.push_back({mean, "mean " + fixed_text(mean, 3), colour});
    }
  }
  const bool has_thesis = !thesis.empty();
  const std::vector<Level> levels = reference_levels(references);
  std::vector<Level> all = best;
  append(all, thesis);
  append(all, levels);
  append(best, levels);
  append(thesis, levels);
  const double second_top = sim::first_panel_top + double_panel_height + between_panels;
  const CurvePanel every = make_panel(sim::first_panel_top, double_panel_height, curves, all);
  const CurvePanel mean = make_panel(second_top, double_panel_height, curves, all);

  Svg svg(sim::page_width, second_top + double_panel_height + 56.0, "Comparison of methods",
          "Best distance so far of every repetition, and its mean, against evaluations.");
  // The legend takes the place of a subtitle.
  const std::string engine = methods.empty() ? std::string() : methods.front().engine;
  sim::draw_title(
      svg, std::string(experiment.title) + ": methods compared" + (engine.empty() ? "" : " (" + engine + " engine)"),
      {});
  sim::draw_legend(svg, plot_right, 54.0, method_legend);
  std::vector<LegendEntry> level_legend{{"without a search; best of all runs", line_style(sim::ink, 1.3, dotted), ""}};
  sim::draw_plot_grid(svg, every.x, every.y, "evaluations", "(a) Every run: best distance so far (m)");
  sim::draw_legend(svg, plot_right, sim::first_panel_top - 16.0, level_legend);
  draw_levels(svg, every, best);
  for (std::size_t i = 0; i < methods.size(); ++i) {
    draw_every_curve(svg, every, methods[i], colours[i]);
  }
  sim::draw_plot_frame(svg, every.x, every.y);
  draw_names(svg, every, best, {});

  sim::draw_plot_grid(svg, mean.x, mean.y, "evaluations", "(b) Mean of the runs (m)");
  if (has_thesis) {
    level_legend.push_back({"the thesis's best", line_style(sim::ink, 1.3, dashed), ""});
  }
  sim::draw_legend(svg, plot_right, second_top - 16.0, level_legend);
  draw_levels(svg, mean, all);
  for (std::size_t i = 0; i < methods.size(); ++i) {
    svg.begin_group("mean");
    draw_curve(svg, mean, curves[i].mean, line_style(colours[i], 2.4));
    svg.end_group();
  }
  sim::draw_plot_frame(svg, mean.x, mean.y);
  draw_names(svg, mean, thesis, means);
  return svg.finish();
}

}  // namespace proleg::optimize
