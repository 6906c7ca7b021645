#pragma once

// A panel of a figure that shows the best scores so far against evaluations: curves, levels to compare them with, and
// their names at the right edge.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/report/best_curves.hpp"
#include "sim/record/axis.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {

inline constexpr double plot_right = 740.0;  ///< the names of lines stand to the right of it

inline constexpr const char* dotted = "1.5 3.5";
inline constexpr const char* dashed = "7 4";

/// SVG attributes of a line.
[[nodiscard]] std::string line_style(const std::string& colour, double width, const std::string& dashes = {});

/// A score for comparison, drawn from edge to edge.
struct Level {
  double value;
  std::string text;
  std::string colour;
  const char* dashes;
};

struct CurvePanel {
  sim::Axis x;
  sim::Axis y;
};

/// Makes a panel in which all curves and levels fit.
[[nodiscard]] CurvePanel make_panel(double top, double height, std::span<const BestCurves> curves,
                                    std::span<const Level> levels);

void draw_levels(sim::Svg& svg, const CurvePanel& panel, std::span<const Level> levels);
/// Draws one curve as steps. style: from line_style().
void draw_curve(sim::Svg& svg, const CurvePanel& panel, const std::vector<double>& best, const std::string& style);
/// Draws the best so far of each repetition.
void draw_every_curve(sim::Svg& svg, const CurvePanel& panel, const MethodRuns& method, const std::string& colour);
/// Draws the names of levels and curves at the right edge.
void draw_names(sim::Svg& svg, const CurvePanel& panel, std::span<const Level> levels,
                std::vector<sim::LineName> names);

}  // namespace proleg::optimize
