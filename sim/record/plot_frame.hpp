#pragma once

// What figures share: the page with its title, styles and colours; and for plots of numbers against numbers a frame
// with grid and numbers, a legend, names beside lines, and lines that stay small however many values they have.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/record/svg.hpp"

namespace proleg::sim {

// Page, in pixels.
inline constexpr double page_width = 900.0;
inline constexpr double page_left = 104.0;
inline constexpr double page_right = 820.0;

inline constexpr double first_panel_top = 104.0;  ///< below title, subtitle and legend

inline constexpr double label_size = 12.0;
inline constexpr double heading_size = 13.5;
inline constexpr const char* ink = "#222222";
inline constexpr const char* faint_ink = "#555555";
inline constexpr const char* grid_style = R"(stroke="#e2e2e2" stroke-width="1")";
inline constexpr const char* frame_style = R"(fill="none" stroke="#777777" stroke-width="1")";

/// Colours that people with any colour vision can distinguish (M. Okabe, K. Ito, 2008; without the yellow, which is too
/// faint on white).
inline constexpr std::array<const char*, 7> distinct_colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                             "#e69f00", "#56b4e9", "#000000"};

/// Draws title and subtitle at the head of the page. The subtitle leaves room for another text at the right edge, at
/// the height subtitle_y. raised_by: pixels.
inline constexpr double subtitle_y = 58.0;
inline void draw_title(Svg& svg, std::string_view title, std::string_view subtitle, double raised_by = 0.0) {
  svg.text({page_left, 36.0 - raised_by}, title, TextAnchor::start, 20.0, ink, R"(font-weight="bold")");
  svg.text({page_left, subtitle_y - raised_by}, subtitle, TextAnchor::start, label_size, faint_ink);
}

inline void draw_heading(Svg& svg, double panel_top, std::string_view text) {
  svg.text({page_left, panel_top - 12.0}, text, TextAnchor::start, heading_size, ink, R"(font-weight="bold")");
}

/// Maps a range of values to a range of pixels, linearly.
struct Axis {
  double low = 0.0;
  double high = 1.0;        ///< above low
  double pixel_low = 0.0;   ///< where `low` is
  double pixel_high = 1.0;  ///< where `high` is; below pixel_low for an axis that points upwards

  [[nodiscard]] double pixel(double value) const {
    return pixel_low + (value - low) / (high - low) * (pixel_high - pixel_low);
  }
};

/// Smallest of ..., 0.1, 0.2, 0.5, 1, 2, 5, ... that is at least `min`, which is above 0.
[[nodiscard]] double nice_step(double min);

/// Multiples of `step` from low to high.
[[nodiscard]] std::vector<double> multiples(double low, double high, double step);

/// Moves positions apart until neighbours have a distance of `gap` or more, within low to high if there is room. Keeps
/// their order; they need not be sorted.
[[nodiscard]] std::vector<double> spread(std::vector<double> positions, double gap, double low, double high);

/// An axis from low to high with a little room at both ends; also if they are equal. Beyond +-10^12 it is cut.
[[nodiscard]] Axis axis_over(double low, double high, double pixel_low, double pixel_high);

/// Grid, numbers and names of two axes: that of y as a heading above the frame, that of x below it.
void draw_plot_grid(Svg& svg, const Axis& x, const Axis& y, std::string_view x_name, std::string_view y_name);
/// The frame around it, to be drawn over the lines.
void draw_plot_frame(Svg& svg, const Axis& x, const Axis& y);

/// In pixels and within the axes, with at most four points (first, lowest, highest, last) in each column of pixels, so
/// that a picture of an hour is no larger than one of a minute and no peak is lost. The trace is finite and ascends in
/// x.
[[nodiscard]] Polyline to_pixels(const Polyline& trace, const Axis& x, const Axis& y);

/// Places of marks of that size (pixels), those beyond the axes at their edge; of marks that would hide each other only
/// the first.
[[nodiscard]] Polyline to_marks(const Polyline& points, const Axis& x, const Axis& y, double size);

/// What a line beside its end is called.
struct LineName {
  double value = 0.0;  ///< where it ends, on the axis
  std::string text;
  std::string colour;
};
/// Names beside the right edge of a plot, moved apart where they would meet.
void draw_line_names(Svg& svg, const Axis& y, double right, std::span<const LineName> names);

/// A sample of a line or mark and what it means.
struct LegendEntry {
  std::string name;
  std::string style;  ///< of the line or mark
  std::string mark;   ///< as Svg::marks has it; empty: a line
};
/// Draws the legend in one row; the last entry's text ends at `right`.
void draw_legend(Svg& svg, double right, double y, std::span<const LegendEntry> entries);

}  // namespace proleg::sim
