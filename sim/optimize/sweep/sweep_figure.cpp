#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/optimize/sweep/sweep.hpp"
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
constexpr const char* cross = "m-3.5 -3.5l7 7m0 -7l-7 7";
constexpr const char* cross_style = R"(stroke="#d55e00" stroke-width="1.5")";
constexpr const char* spread_style = R"(stroke="#0072b2" stroke-width="1" stroke-dasharray="4 3")";

double value_of(const Sweep& sweep, const SweepGroup& group, std::size_t quantity) {
  return parse_number(sweep.quantities[quantity].values[group.combination[quantity]]).value_or(0.0);
}

std::string measure_name(sim::Measure measure) {
  const sim::MeasureDeclaration& declaration = sim::declaration_of(measure);
  return with_unit(declaration.name, declaration.unit);
}

std::string quantity_name(const SweptQuantity& quantity) { return with_unit(shortened(quantity.name), quantity.unit); }

/// Subtitle like "uniform.simulation.xml: amplitude 10 to 50 deg, seed 1 to 10".
std::string subtitle(const Sweep& sweep) {
  std::string text = std::filesystem::path(sweep.scenario.path).filename().string() + ":";
  for (const SweptQuantity& quantity : sweep.quantities) {
    text += (&quantity == &sweep.quantities.front() ? " " : ", ") + shortened(quantity.name) + " " +
            quantity.values.front() + (quantity.values.size() > 1 ? " to " + quantity.values.back() : "") +
            (quantity.unit.empty() ? "" : " " + quantity.unit);
  }
  return text;
}

Svg begin_page(const Sweep& sweep, sim::Measure measure, const std::string& description) {
  constexpr std::size_t max_characters = 115;  // this number fits the page
  const std::string title = measure_name(measure);
  Svg svg(sim::page_width, page_height, title, description + " Made by: " + command_of(sweep));
  constexpr double line = 15.0;  // higher by a line, because there are two subtitles
  sim::draw_title(svg, title, shortened(subtitle(sweep), max_characters), line);
  svg.text({sim::page_left, sim::subtitle_y}, shortened(fixed_options(sweep), max_characters), sim::TextAnchor::start,
           sim::label_size, sim::faint_ink);
  return svg;
}

/// The marks that are drawn over one quantity. A mean without a standard deviation has no spread.
struct Traces {
  /// The means of neighbouring groups that have one.
  struct Section {
    Polyline mean;
    Polyline lower;
    Polyline upper;
  };
  Polyline dots;
  std::vector<Section> sections;
  std::vector<double> gaps;  ///< positions where no run has a value

  void add(double x, const SweepGroup& group) {
    if (group.values.empty()) {
      gaps.push_back(x);
      in_gap_ = true;
      return;
    }
    if (in_gap_) {
      sections.emplace_back();
      in_gap_ = false;
    }
    for (const double value : group.values) {
      dots.push_back({x, drawable(value)});
    }
    const double deviation = std::isfinite(group.deviation()) ? group.deviation() : 0.0;
    sections.back().mean.push_back({x, drawable(group.mean())});
    sections.back().lower.push_back({x, drawable(group.mean() - deviation)});
    sections.back().upper.push_back({x, drawable(group.mean() + deviation)});
  }

 private:
  bool in_gap_ = true;
};

/// The lowest and the highest of at least one value.
std::array<double, 2> range_of(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  return {low, high};
}

sim::Axis x_axis(const Traces& traces) {
  std::vector<double> places = traces.gaps;
  for (const sim::Point& dot_place : traces.dots) {
    places.push_back(dot_place.x);
  }
  const auto [left, right] = range_of(places);
  return sim::axis_over(left, right, sim::page_left, sim::page_right);
}

sim::Axis y_axis(const Traces& traces) {
  std::vector<double> heights;
  const auto add = [&heights](const Polyline& line) {
    for (const sim::Point& point : line) {
      heights.push_back(point.y);
    }
  };
  add(traces.dots);
  for (const Traces::Section& section : traces.sections) {
    add(section.lower);
    add(section.upper);
  }
  const auto [low, high] = range_of(heights);
  return sim::axis_over(low, high, panel_bottom, sim::first_panel_top);
}

/// Draws crosses on the lower edge.
void draw_gaps(Svg& svg, const Traces& traces, const sim::Axis& x) {
  if (traces.gaps.empty()) {
    return;
  }
  Polyline places;
  for (const double gap : traces.gaps) {
    places.push_back({x.pixel(gap), panel_bottom - 7.0});
  }
  svg.begin_group("gaps");
  svg.marks(places, cross, cross_style);
  svg.end_group();
}

std::string draw_line(const Sweep& sweep, std::span<const SweepGroup> groups, std::size_t quantity,
                      sim::Measure measure) {
  Traces traces;
  for (const SweepGroup& group : groups) {
    traces.add(value_of(sweep, group, quantity), group);
  }
  const sim::Axis x = x_axis(traces);
  const sim::Axis y = y_axis(traces);

  Svg svg = begin_page(sweep, measure, "A measure over a swept quantity; dots are runs, the line joins their means.");
  std::vector<sim::LegendEntry> entries{
      {"run", dot_style, dot}, {"mean", line_style, ""}, {"standard deviation", spread_style, ""}};
  if (!traces.gaps.empty()) {
    entries.push_back({"no value", cross_style, cross});
  }
  sim::draw_legend(svg, sim::page_right, sim::first_panel_top - 16.0, entries);
  sim::draw_plot_grid(svg, x, y, quantity_name(sweep.quantities[quantity]), measure_name(measure));
  svg.begin_group("runs");
  svg.marks(sim::to_marks(traces.dots, x, y, 2.5), dot, dot_style);
  svg.end_group();
  svg.begin_group("mean");
  for (const Traces::Section& section : traces.sections) {
    svg.polyline(sim::to_pixels(section.lower, x, y), spread_style);
    svg.polyline(sim::to_pixels(section.upper, x, y), spread_style);
    svg.polyline(sim::to_pixels(section.mean, x, y), line_style);
  }
  svg.end_group();
  draw_gaps(svg, traces, x);
  sim::draw_plot_frame(svg, x, y);
  return svg.finish();
}

/// Colours of numbers. Numbers of one sign go from pale to dark: positive ones in blue, dark for the highest, and
/// negative ones in orange, dark for the lowest. If both signs occur, 0 is pale, and a number and its negative are
/// equally dark.
class ColourScale {
 public:
  /// low: at most high.
  ColourScale(double low, double high) : low_(low), high_(high) {
    if (low < 0.0 && high > 0.0) {
      high_ = std::max(-low, high);
      low_ = -high_;
    }
  }

  /// The numbers that the darkest and palest colours mean.
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }

  /// Place of a number on the scale from -1, dark orange, over 0, pale, to 1, dark blue.
  [[nodiscard]] double share(double value) const {
    if (low_ < 0.0 && high_ > 0.0) {
      return value / high_;
    }
    const bool is_negative = low_ < 0.0;
    if (low_ == high_) {
      return is_negative ? -0.5 : 0.5;
    }
    return is_negative ? -(high_ - value) / (high_ - low_) : (value - low_) / (high_ - low_);
  }

  [[nodiscard]] std::string fill(double value) const {
    constexpr std::array<double, 3> pale{243.0, 243.0, 243.0};
    constexpr std::array<double, 3> dark_blue{8.0, 48.0, 107.0};
    constexpr std::array<double, 3> dark_orange{127.0, 39.0, 4.0};
    const double its_share = share(value);
    const std::array<double, 3>& dark = its_share < 0.0 ? dark_orange : dark_blue;
    const auto mix = [&](std::size_t i) {
      return static_cast<unsigned>(std::lround(std::lerp(pale[i], dark[i], std::abs(its_share))));
    };
    std::array<char, 8> text{};
    std::snprintf(text.data(), text.size(), "#%02x%02x%02x", mix(0), mix(1), mix(2));
    return std::string("fill=\"") + text.data() + "\"";
  }

 private:
  double low_;
  double high_;
};

/// The scale for the lowest and the highest mean of the groups; at least one group has a mean.
ColourScale scale_of(std::span<const SweepGroup> groups) {
  std::vector<double> means;
  for (const SweepGroup& group : groups) {
    if (!group.values.empty()) {
      means.push_back(group.mean());
    }
  }
  const auto [low, high] = range_of(means);
  return {low, high};
}

/// The cells of a map, and the numbers that their colours mean.
class Map {
 public:
  Map(const Sweep& sweep, std::span<const SweepGroup> groups, std::size_t column, std::size_t row)
      : sweep_(&sweep), groups_(groups), column_(column), row_(row), scale_(scale_of(groups)) {}

  void draw(Svg& svg) const {
    svg.begin_group("map");
    for (const SweepGroup& group : groups_) {
      draw_cell(svg, group);
    }
    svg.end_group();
    draw_gaps(svg);
    draw_names(svg);
    draw_scale(svg);
  }

 private:
  static constexpr double max_named = 16.0;  ///< most values that are written beside an axis

  [[nodiscard]] const SweptQuantity& column() const { return sweep_->quantities[column_]; }
  [[nodiscard]] const SweptQuantity& row() const { return sweep_->quantities[row_]; }
  [[nodiscard]] double columns() const { return static_cast<double>(column().values.size()); }
  [[nodiscard]] double rows() const { return static_cast<double>(row().values.size()); }
  [[nodiscard]] double width() const { return (sim::page_right - sim::page_left) / columns(); }
  [[nodiscard]] double height() const { return (panel_bottom - sim::first_panel_top) / rows(); }
  /// The upper left corner of a cell.
  [[nodiscard]] sim::Point corner(const SweepGroup& group) const {
    return {sim::page_left + width() * group.combination[column_],
            panel_bottom - height() * (group.combination[row_] + 1.0)};
  }
  [[nodiscard]] bool has_gaps() const {
    return std::ranges::any_of(groups_, [](const SweepGroup& group) { return group.values.empty(); });
  }

  void draw_cell(Svg& svg, const SweepGroup& group) const {
    if (group.values.empty()) {
      return;  // the cell stays white
    }
    const double mean = group.mean();
    const sim::Point place = corner(group);
    svg.rectangle(place, width(), height(), scale_.fill(mean));
    constexpr double min_width = 44.0;
    constexpr double min_height = 16.0;
    constexpr double dark_cell = 0.6;  // a darker cell has white text
    if (width() >= min_width && height() >= min_height) {
      svg.text({place.x + width() / 2.0, place.y + height() / 2.0 + 4.0}, rounded_text(mean + 0.0),
               sim::TextAnchor::middle, sim::label_size,
               std::abs(scale_.share(mean)) > dark_cell ? "#ffffff" : sim::ink);
    }
  }

  void draw_gaps(Svg& svg) const {
    if (!has_gaps()) {
      return;
    }
    Polyline places;
    for (const SweepGroup& group : groups_) {
      if (group.values.empty()) {
        places.push_back({corner(group).x + width() / 2.0, corner(group).y + height() / 2.0});
      }
    }
    svg.begin_group("gaps");
    svg.marks(places, cross, cross_style);
    svg.end_group();
  }

  void draw_names(Svg& svg) const {
    const auto every = [](double count) { return static_cast<std::size_t>(std::ceil(count / max_named)); };
    for (std::size_t i = 0; i < column().values.size(); i += every(columns())) {
      svg.text({sim::page_left + width() * (static_cast<double>(i) + 0.5), panel_bottom + 19.0}, column().values[i],
               sim::TextAnchor::middle, sim::label_size, sim::ink);
    }
    for (std::size_t i = 0; i < row().values.size(); i += every(rows())) {
      svg.text({sim::page_left - 8.0, panel_bottom - height() * (static_cast<double>(i) + 0.5) + 4.0}, row().values[i],
               sim::TextAnchor::end, sim::label_size, sim::ink);
    }
    svg.text({(sim::page_left + sim::page_right) / 2.0, panel_bottom + 37.0}, quantity_name(column()),
             sim::TextAnchor::middle, sim::label_size, sim::ink);
    sim::draw_heading(svg, sim::first_panel_top, quantity_name(row()));
  }

  /// Draws a bar with the colours, and the numbers at its ends and, if both signs occur, 0 in its middle.
  void draw_scale(Svg& svg) const {
    constexpr double top = sim::first_panel_top - 21.0;
    constexpr double bar_height = 10.0;
    constexpr double bar_right = sim::page_right - 70.0;
    constexpr double bar_width = 160.0;
    constexpr double bar_left = bar_right - bar_width;
    constexpr double text_y = top + bar_height - 1.0;
    constexpr int colours = 40;
    svg.begin_group("scale");
    for (int i = 0; i < colours; ++i) {
      const double value = std::lerp(scale_.low(), scale_.high(), (i + 0.5) / colours);
      svg.rectangle({bar_left + bar_width * i / colours, top}, bar_width / colours + 0.5, bar_height,
                    scale_.fill(value));
    }
    svg.text({bar_right + 6.0, text_y}, rounded_text(scale_.high() + 0.0), sim::TextAnchor::start, sim::label_size,
             sim::ink);
    const std::string low = "mean: " + rounded_text(scale_.low() + 0.0);
    svg.text({bar_left - 6.0, text_y}, low, sim::TextAnchor::end, sim::label_size, sim::ink);
    if (scale_.low() < 0.0 && scale_.high() > 0.0) {
      const double middle = bar_left + bar_width / 2.0;
      svg.line({middle, top}, {middle, top + bar_height}, R"(stroke="#777777" stroke-width="1")");
      svg.text({middle + 4.0, text_y}, "0", sim::TextAnchor::start, sim::label_size, sim::ink);
    }
    if (has_gaps()) {
      const std::array<sim::LegendEntry, 1> gap{{{"no value", cross_style, cross}}};
      sim::draw_legend(svg, bar_left - 140.0, top + bar_height / 2.0, gap);
    }
    svg.end_group();
  }

  const Sweep* sweep_;
  std::span<const SweepGroup> groups_;
  std::size_t column_;
  std::size_t row_;
  ColourScale scale_;
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
  const bool has_value = std::ranges::any_of(groups, [](const SweepGroup& group) { return !group.values.empty(); });
  if (varied.empty() || varied.size() > 2 || !has_value) {
    return {};
  }
  return varied.size() == 2 ? draw_map(sweep, groups, varied[0], varied[1], measure)
                            : draw_line(sweep, groups, varied[0], measure);
}

}  // namespace proleg::optimize
