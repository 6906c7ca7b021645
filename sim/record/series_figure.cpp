#include "sim/record/series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/record/plot_frame.hpp"

namespace proleg::sim {
namespace {

constexpr double series_page_width = 1000.0;
constexpr double series_right = 760.0;  // the legend stands to the right of it
constexpr double legend_row = 17.0;
constexpr double min_panel_height = 230.0;
constexpr double path_panel_height = 460.0;
constexpr double below_panel = 74.0;  // numbers, the name of the axis, and the heading of the next panel

using NameAndUnit = std::pair<std::string_view, std::string_view>;

// Endings of the columns of `proleg export`, longer ones first.
constexpr std::array<NameAndUnit, 12> suffixes{{{"_m_per_s2", "m/s^2"},
                                                {"_per_s", "1/s"},
                                                {"_deg", "deg"},
                                                {"_Hz", "Hz"},
                                                {"_Nm", "Nm"},
                                                {"_mA", "mA"},
                                                {"_us", "us"},
                                                {"_ms", "ms"},
                                                {"_N", "N"},
                                                {"_m", "m"},
                                                {"_s", "s"},
                                                {"_J", "J"}}};

// Types of the thesis's data files.
constexpr std::array<NameAndUnit, 18> thesis_types{{{"Angle", "deg"},
                                                    {"desired_angle", "deg"},
                                                    {"Time", "s"},
                                                    {"Phase_Difference", "deg"},
                                                    {"Frequency", "Hz"},
                                                    {"speed", "m/s"},
                                                    {"x_pos", "m"},
                                                    {"y_pos", "m"},
                                                    {"z_pos", "m"},
                                                    {"alpha", "deg"},
                                                    {"beta", "deg"},
                                                    {"gamma", "deg"},
                                                    {"potential_energy", "J"},
                                                    {"average_com_speed", "m/s"},
                                                    {"desired_joint_positions", "deg"},
                                                    {"real_joint_positions", "deg"},
                                                    {"servo_currents", "mA"},
                                                    {"servo_speeds", "deg/s"}}};

/// A name in a title: "angle (deg)".
std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " (" + unit + ")";
}

std::string readable(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

struct SeriesStyle {
  std::string colour;
  std::string attributes;
};

SeriesStyle style_of(std::size_t number) {
  constexpr std::array<const char*, 3> dashes{"", R"( stroke-dasharray="7 4")", R"( stroke-dasharray="1.5 3.5")"};
  static_assert(max_series == dashes.size() * distinct_colours.size());
  const std::string colour = distinct_colours[number % distinct_colours.size()];
  return {colour, "stroke=\"" + colour + "\" stroke-width=\"1.5\" stroke-linejoin=\"round\"" +
                      dashes[number / distinct_colours.size() % dashes.size()]};
}

/// The series with one unit.
struct SeriesPanel {
  std::string unit;
  std::vector<std::string> quantities;
  std::vector<const Series*> series;
};

std::vector<SeriesPanel> panels_of(const SeriesSet& set) {
  std::vector<SeriesPanel> panels;
  for (const Series& series : set.series) {
    const Quantity quantity = quantity_of(series.name);
    auto panel = std::ranges::find(panels, quantity.unit, &SeriesPanel::unit);
    if (panel == panels.end()) {
      panel = panels.insert(panels.end(), {quantity.unit, {}, {}});
    }
    if (std::ranges::find(panel->quantities, quantity.name) == panel->quantities.end()) {
      panel->quantities.push_back(quantity.name);
    }
    panel->series.push_back(&series);
  }
  return panels;
}

std::string heading_of(const SeriesPanel& panel) {
  std::string names;
  for (const std::string& quantity : panel.quantities) {
    names += (names.empty() ? "" : ", ") + readable(quantity);
  }
  return with_unit(shortened(names, 80), panel.unit);
}

bool is_finite(const Point& point) { return std::isfinite(point.x) && std::isfinite(point.y); }

struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] Axis axis(double pixel_low, double pixel_high) const {
    return low <= high ? axis_over(low, high, pixel_low, pixel_high) : Axis{0.0, 1.0, pixel_low, pixel_high};
  }
};

/// Widens the axis with the finer scale until both have the same.
void make_scales_equal(Axis& x, Axis& y) {
  const double x_scale = (x.high - x.low) / (x.pixel_high - x.pixel_low);
  const double y_scale = (y.high - y.low) / (y.pixel_low - y.pixel_high);
  Axis& finer = x_scale < y_scale ? x : y;
  const double factor = std::max(x_scale, y_scale) / std::min(x_scale, y_scale);
  const double middle = (finer.low + finer.high) / 2.0;
  const double half = (finer.high - finer.low) / 2.0 * factor;
  finer.low = middle - half;
  finer.high = middle + half;
}

/// The path in pixels, without points that would be at the place of the one before.
Polyline path_in_pixels(const Polyline& run, const Axis& x, const Axis& y) {
  constexpr double min_distance = 0.4;
  Polyline pixels;
  for (const Point& point : run) {
    const Point pixel{x.pixel(std::clamp(point.x, x.low, x.high)), y.pixel(std::clamp(point.y, y.low, y.high))};
    if (pixels.empty() || std::hypot(pixel.x - pixels.back().x, pixel.y - pixels.back().y) >= min_distance) {
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

void draw_one_series(Svg& svg, const Series& series, const Axis& x, const Axis& y, bool over_time,
                     const SeriesStyle& style) {
  const auto draw = [&](const Polyline& run) {
    const Polyline pixels = over_time ? to_pixels(run, x, y) : path_in_pixels(run, x, y);
    if (pixels.size() == 1) {
      svg.circle(pixels.front(), 1.5, "fill=\"" + style.colour + "\"");
    } else if (!pixels.empty()) {
      svg.polyline(pixels, style.attributes);
    }
  };
  Polyline run;
  bool has_start = over_time;
  for (const Point& point : series.points) {
    if (is_finite(point)) {
      run.push_back(point);
      if (!has_start) {
        has_start = true;
        svg.circle({x.pixel(point.x), y.pixel(point.y)}, 4.0, "fill=\"" + style.colour + "\"");
      }
      continue;
    }
    draw(run);
    run.clear();
  }
  draw(run);
}

}  // namespace

Quantity quantity_of(std::string_view column) {
  const std::string_view name = column.substr(0, column.find('.'));
  if (const auto type = std::ranges::find(thesis_types, name, &NameAndUnit::first); type != thesis_types.end()) {
    return {std::string(name), std::string(type->second)};
  }
  for (const auto& [suffix, unit] : suffixes) {
    if (name.size() > suffix.size() && name.ends_with(suffix)) {
      return {std::string(name.substr(0, name.size() - suffix.size())), std::string(unit)};
    }
  }
  return {std::string(name), {}};
}

std::string draw_series(const SeriesSet& set, std::string_view title, std::string_view subtitle) {
  const Quantity x_quantity = quantity_of(set.x_name);
  const bool over_time = set.x_name == "time_s";
  const std::vector<SeriesPanel> panels = panels_of(set);
  const bool is_path =
      !over_time && !x_quantity.unit.empty() && panels.size() == 1 && panels[0].unit == x_quantity.unit;

  Span x_span;
  std::vector<double> heights;
  double page_height = first_panel_top - below_panel;
  for (const SeriesPanel& panel : panels) {
    heights.push_back(std::max(
        {is_path ? path_panel_height : min_panel_height, legend_row * static_cast<double>(panel.series.size())}));
    page_height += heights.back() + below_panel;
    for (const Series* series : panel.series) {
      for (const Point& point : series->points) {
        if (is_finite(point)) {
          x_span.include(point.x);
        }
      }
    }
  }
  Axis x = over_time ? Axis{set.from_s, set.to_s, page_left, series_right} : x_span.axis(page_left, series_right);

  Svg svg(series_page_width, page_height + 56.0, title, "Columns of a recording, one over the other.");
  draw_title(svg, title, subtitle);
  double top = first_panel_top;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const SeriesPanel& panel = panels[i];
    Span y_span;
    for (const Series* series : panel.series) {
      for (const Point& point : series->points) {
        if (is_finite(point)) {
          y_span.include(point.y);
        }
      }
    }
    Axis y = y_span.axis(top + heights[i], top);
    if (is_path) {
      make_scales_equal(x, y);
    }
    const std::string_view part =
        set.x_name.find('.') == std::string::npos ? "" : std::string_view(set.x_name).substr(set.x_name.find('.') + 1);
    const std::string x_name = readable(x_quantity.name) + (part.empty() ? "" : " of " + std::string(part));
    draw_plot_grid(svg, x, y, with_unit(x_name, x_quantity.unit), heading_of(panel));
    svg.begin_group("series");
    double row = top + 8.0;
    std::size_t number = 0;
    for (const Series* series : panel.series) {
      const SeriesStyle style = style_of(number++);
      draw_one_series(svg, *series, x, y, over_time, style);
      svg.line({series_right + 14.0, row}, {series_right + 42.0, row}, style.attributes);
      svg.text({series_right + 48.0, row + 4.0}, shortened(series->name, 28), TextAnchor::start, label_size, ink);
      row += legend_row;
    }
    svg.end_group();
    draw_plot_frame(svg, x, y);
    top += heights[i] + below_panel;
  }
  return svg.finish();
}

}  // namespace proleg::sim
