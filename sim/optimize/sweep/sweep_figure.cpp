#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/optimize/sweep/sweep.hpp"
#include "sim/record/figure_page.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {
namespace {

using sim::Polyline;
using sim::Svg;

constexpr double panel_bottom = 540.0;
constexpr double page_height = panel_bottom + 56.0;
constexpr const char* dot = "h0";
constexpr const char* dot_style = R"(stroke="#8fb3c9" stroke-width="4" stroke-linecap="round")";
constexpr const char* line_style = R"(stroke="#0072b2" stroke-width="2" stroke-linejoin="round")";
constexpr const char* spread_style = R"(stroke="#0072b2" stroke-width="1" stroke-dasharray="4 3")";

double value_of(const Sweep& sweep, const SweepGroup& group, std::size_t quantity) {
  return parse_number(sweep.quantities[quantity].values[group.combination[quantity]]).value_or(0.0);
}

std::string measure_name(sim::Measure measure) {
  const sim::MeasureDeclaration& declaration = sim::declaration_of(measure);
  return with_unit(declaration.name, declaration.unit);
}

std::string subtitle(const Sweep& sweep) {
  std::string text;
  for (const SweptQuantity& quantity : sweep.quantities) {
    text += (text.empty() ? "" : ", ") + shortened(quantity.name) + " " + quantity.values.front() +
            (quantity.values.size() > 1 ? " to " + quantity.values.back() : "");
  }
  return text;
}

Svg begin_page(const Sweep& sweep, sim::Measure measure, const std::string& description) {
  const std::string title = measure_name(measure);
  Svg svg(sim::page_width, page_height, title, description);
  sim::draw_title(svg, title, subtitle(sweep));
  return svg;
}

/// What is drawn over one quantity. A mean without a standard deviation has no spread.
struct Traces {
  Polyline dots;
  Polyline mean;
  Polyline lower;
  Polyline upper;

  void add(double x, const SweepGroup& group) {
    for (const double value : group.values) {
      dots.push_back({x, drawable(value)});
    }
    if (!group.values.empty()) {
      const double deviation = std::isfinite(group.deviation()) ? group.deviation() : 0.0;
      mean.push_back({x, drawable(group.mean())});
      lower.push_back({x, drawable(group.mean() - deviation)});
      upper.push_back({x, drawable(group.mean() + deviation)});
    }
  }
};

/// The lowest and the highest value of a coordinate; 0 and 1 without points.
std::array<double, 2> range_of(std::initializer_list<const Polyline*> lines, double sim::Point::*coordinate) {
  std::array<double, 2> range{INFINITY, -INFINITY};
  for (const Polyline* line : lines) {
    for (const sim::Point& point : *line) {
      range = {std::min(range[0], point.*coordinate), std::max(range[1], point.*coordinate)};
    }
  }
  return range[0] <= range[1] ? range : std::array{0.0, 1.0};
}

std::string draw_line(const Sweep& sweep, std::span<const SweepGroup> groups, std::size_t quantity,
                      sim::Measure measure) {
  Traces traces;
  for (const SweepGroup& group : groups) {
    traces.add(value_of(sweep, group, quantity), group);
  }
  const auto [left, right] = range_of({&traces.dots}, &sim::Point::x);
  const auto [low, high] = range_of({&traces.dots, &traces.lower, &traces.upper}, &sim::Point::y);
  const sim::Axis x = sim::axis_over(left, right, sim::page_left, sim::page_right);
  const sim::Axis y = sim::axis_over(low, high, panel_bottom, sim::first_panel_top);

  Svg svg = begin_page(sweep, measure, "A measure over a swept quantity; dots are runs, the line joins their means.");
  const std::array<sim::LegendEntry, 3> entries{
      {{"run", dot_style, dot}, {"mean", line_style, ""}, {"standard deviation", spread_style, ""}}};
  sim::draw_legend(svg, sim::page_right, sim::first_panel_top - 16.0, entries);
  sim::draw_plot_grid(svg, x, y, shortened(sweep.quantities[quantity].name), measure_name(measure));
  svg.begin_group("runs");
  svg.marks(sim::to_marks(traces.dots, x, y, 2.5), dot, dot_style);
  svg.end_group();
  svg.begin_group("mean");
  svg.polyline(sim::to_pixels(traces.lower, x, y), spread_style);
  svg.polyline(sim::to_pixels(traces.upper, x, y), spread_style);
  svg.polyline(sim::to_pixels(traces.mean, x, y), line_style);
  svg.end_group();
  sim::draw_plot_frame(svg, x, y);
  return svg.finish();
}

/// From pale to dark blue; share: 0 to 1.
std::string colour_of(double share) {
  constexpr std::array<double, 3> pale{240.0, 246.0, 250.0};
  constexpr std::array<double, 3> dark{8.0, 48.0, 107.0};
  std::array<char, 8> text{};
  const auto mix = [&](std::size_t i) {
    return static_cast<unsigned>(std::lround(std::lerp(pale[i], dark[i], share)));
  };
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", mix(0), mix(1), mix(2));
  return text.data();
}

/// The cells of a map, and the numbers that their colours mean.
class Map {
 public:
  Map(const Sweep& sweep, std::span<const SweepGroup> groups, std::size_t column, std::size_t row)
      : sweep_(&sweep), groups_(groups), column_(column), row_(row) {
    for (const SweepGroup& group : groups) {
      if (const double mean = group.mean(); std::isfinite(mean)) {
        low_ = std::min(low_, mean);
        high_ = std::max(high_, mean);
      }
    }
  }

  void draw(Svg& svg) const {
    svg.begin_group("map");
    for (const SweepGroup& group : groups_) {
      draw_cell(svg, group);
    }
    svg.end_group();
    draw_names(svg);
  }

 private:
  static constexpr double max_named = 16.0;  ///< values beside an axis

  [[nodiscard]] double columns() const { return static_cast<double>(sweep_->quantities[column_].values.size()); }
  [[nodiscard]] double rows() const { return static_cast<double>(sweep_->quantities[row_].values.size()); }
  [[nodiscard]] double width() const { return (sim::page_right - sim::page_left) / columns(); }
  [[nodiscard]] double height() const { return (panel_bottom - sim::first_panel_top) / rows(); }

  void draw_cell(Svg& svg, const SweepGroup& group) const {
    const double mean = group.mean();
    if (!std::isfinite(mean)) {
      return;  // it stays white
    }
    const sim::Point corner{sim::page_left + width() * group.combination[column_],
                            panel_bottom - height() * (group.combination[row_] + 1.0)};
    const double share = high_ > low_ ? (mean - low_) / (high_ - low_) : 0.5;
    svg.rectangle(corner, width(), height(), "fill=\"" + colour_of(share) + "\"");
    constexpr double min_width = 44.0;
    constexpr double min_height = 16.0;
    if (width() >= min_width && height() >= min_height) {
      svg.text({corner.x + width() / 2.0, corner.y + height() / 2.0 + 4.0}, rounded_text(mean), sim::TextAnchor::middle,
               sim::label_size, share > 0.5 ? "#ffffff" : sim::ink);
    }
  }

  void draw_names(Svg& svg) const {
    const SweptQuantity& column = sweep_->quantities[column_];
    const SweptQuantity& row = sweep_->quantities[row_];
    const auto every = [](double count) { return static_cast<std::size_t>(std::ceil(count / max_named)); };
    for (std::size_t i = 0; i < column.values.size(); i += every(columns())) {
      svg.text({sim::page_left + width() * (static_cast<double>(i) + 0.5), panel_bottom + 19.0}, column.values[i],
               sim::TextAnchor::middle, sim::label_size, sim::ink);
    }
    for (std::size_t i = 0; i < row.values.size(); i += every(rows())) {
      svg.text({sim::page_left - 8.0, panel_bottom - height() * (static_cast<double>(i) + 0.5) + 4.0}, row.values[i],
               sim::TextAnchor::end, sim::label_size, sim::ink);
    }
    svg.text({(sim::page_left + sim::page_right) / 2.0, panel_bottom + 37.0}, shortened(column.name),
             sim::TextAnchor::middle, sim::label_size, sim::ink);
    const std::string range =
        low_ <= high_ ? ": " + rounded_text(low_) + " (pale) to " + rounded_text(high_) + " (dark)" : "";
    sim::draw_heading(svg, sim::first_panel_top, shortened(row.name) + "; mean" + range);
  }

  const Sweep* sweep_;
  std::span<const SweepGroup> groups_;
  std::size_t column_;
  std::size_t row_;
  double low_ = INFINITY;
  double high_ = -INFINITY;
};

std::string draw_map(const Sweep& sweep, std::span<const SweepGroup> groups, std::size_t column, std::size_t row,
                     sim::Measure measure) {
  Svg svg = begin_page(sweep, measure, "The mean of a measure over two swept quantities.");
  Map(sweep, groups, column, row).draw(svg);
  svg.rectangle({sim::page_left, sim::first_panel_top}, sim::page_right - sim::page_left,
                panel_bottom - sim::first_panel_top, sim::frame_style);
  return svg.finish();
}

}  // namespace

std::string draw_sweep(const Sweep& sweep, std::span<const SweepGroup> groups, sim::Measure measure) {
  const std::vector<std::size_t> varied = varied_quantities(sweep);
  if (varied.empty() || varied.size() > 2) {
    return {};
  }
  return varied.size() == 2 ? draw_map(sweep, groups, varied[0], varied[1], measure)
                            : draw_line(sweep, groups, varied[0], measure);
}

}  // namespace proleg::optimize
