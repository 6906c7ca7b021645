#include "sim/optimize/report/curve_panel.hpp"

#include <algorithm>
#include <cmath>

#include "sim/optimize/report/scores.hpp"
#include "sim/record/figure_page.hpp"

namespace proleg::optimize {
namespace {

using sim::Axis;
using sim::LineName;
using sim::Polyline;
using sim::Svg;

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

}  // namespace

std::string line_style(const std::string& colour, double width, const std::string& dashes) {
  return "stroke=\"" + colour + "\" stroke-width=\"" + sim::plain_number(width, 2) + "\" stroke-linejoin=\"round\"" +
         (dashes.empty() ? "" : " stroke-dasharray=\"" + dashes + "\"");
}

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

void draw_curve(Svg& svg, const CurvePanel& panel, const std::vector<double>& best, const std::string& style) {
  svg.polyline(sim::to_pixels(steps(best), panel.x, panel.y), style);
}

void draw_every_curve(Svg& svg, const CurvePanel& panel, const MethodRuns& method, const std::string& colour) {
  svg.begin_group("run");
  for (const std::vector<Evaluation>& run : method.runs) {
    draw_curve(svg, panel, best_so_far(run), line_style(colour, 1.1) + R"( stroke-opacity="0.65")");
  }
  svg.end_group();
}

void draw_names(Svg& svg, const CurvePanel& panel, std::span<const Level> levels, std::vector<LineName> names) {
  for (const Level& level : levels) {
    if (std::isfinite(level.value)) {
      names.push_back({level.value, level.text, level.colour});
    }
  }
  sim::draw_line_names(svg, panel.y, plot_right, names);
}

}  // namespace proleg::optimize
