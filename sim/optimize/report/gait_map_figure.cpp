#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

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

constexpr double map_bottom = 560.0;
constexpr double bar_width = 16.0;
constexpr double map_right = sim::page_right - 84.0;
constexpr double small_height = 110.0;
constexpr double small_gap = 76.0;
constexpr double map_page_height = map_bottom + 2.0 * (small_height + small_gap) + 56.0;
constexpr const char* curve_style = R"(stroke="#0072b2" stroke-width="1.6" stroke-linejoin="round")";
constexpr const char* empty_style = R"(fill="#f2f2f2")";

/// Number of colours of the scores: few, so that a picture with many cells stays small.
constexpr std::size_t colour_count = 24;

using Colour = std::array<double, 3>;
/// From low to high; its lightness rises, so that it also shows without colour.
constexpr std::array<Colour, 5> ramp{{{44, 26, 82}, {49, 84, 148}, {33, 145, 140}, {122, 195, 92}, {250, 226, 64}}};

/// attribute: "fill" or "stroke".
std::string colour_style(const char* attribute, std::size_t number) {
  const double place = static_cast<double>(number) / (colour_count - 1) * (ramp.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), ramp.size() - 2);
  std::array<char, 32> text{};
  Colour mixed{};
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    mixed[i] = std::lerp(ramp[below][i], ramp[below + 1][i], place - static_cast<double>(below));
  }
  std::snprintf(text.data(), text.size(), "%s=\"#%02x%02x%02x\"", attribute, static_cast<unsigned>(mixed[0]),
                static_cast<unsigned>(mixed[1]), static_cast<unsigned>(mixed[2]));
  return text.data();
}

std::string axis_text(const Experiment& experiment, std::size_t axis) {
  const Objective& measure = experiment.objectives[1 + axis];
  return with_unit(measure.name, measure.unit());
}

/// A plot of axes 1 and 2. That of a grid is in each column and row of axes 3 and 4.
class MapPlot {
 public:
  explicit MapPlot(const Experiment& experiment, const GaitMap& map) : experiment_(experiment), map_(map) {
    for (std::size_t i = 0; i < experiment.axes.size() && map.tessellation() == nullptr; ++i) {
      cells_[i] = experiment.axes[i].cells;
    }
    plot_width_ = (map_right - sim::page_left - gap * (cells_[2] - 1.0)) / cells_[2];
    plot_height_ = (map_bottom - sim::first_panel_top - gap * (cells_[3] - 1.0)) / cells_[3];
  }

  /// elites: filled cells of the map.
  void draw(Svg& svg, std::span<const GaitMap::Elite> elites, const Axis& scale) const {
    if (map_.tessellation() == nullptr) {
      draw_grid(svg, elites, scale);
    } else if (experiment_.axes.size() == 2) {
      draw_regions(svg, elites, scale);
    } else {
      draw_dots(svg, elites, scale);
    }
    draw_names(svg);
  }

  /// Writes a text onto a cell.
  void mark(Svg& svg, std::size_t cell, std::string_view text, bool is_best) const {
    const Point middle = middle_of(cell);
    if (is_best) {
      svg.circle(middle, 11.0, R"(fill="none" stroke="#ffffff" stroke-width="4")");
      svg.circle(middle, 11.0, R"(fill="none" stroke="#d55e00" stroke-width="2")");
    }
    svg.text({middle.x, middle.y + 4.0}, text, sim::TextAnchor::middle, sim::label_size, sim::ink,
             R"(font-weight="bold" stroke="#ffffff" stroke-width="3" paint-order="stroke")");
  }

 private:
  static constexpr double gap = 6.0;
  static constexpr double overlap = 0.3;

  static std::size_t colour_of(const GaitMap::Elite& elite, const Axis& scale) {
    const double share = (elite.score - scale.low) / (scale.high - scale.low);
    return static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * (colour_count - 1)));
  }

  void draw_grid(Svg& svg, std::span<const GaitMap::Elite> elites, const Axis& scale) const {
    std::array<Polyline, colour_count> starts;
    for (const GaitMap::Elite& elite : elites) {
      starts[colour_of(elite, scale)].push_back(start(map_.place(elite.cell)));
    }
    for (std::uint32_t column = 0; column < cells_[2]; ++column) {
      for (std::uint32_t row = 0; row < cells_[3]; ++row) {
        svg.rectangle(plot_corner(column, row), plot_width_, plot_height_, empty_style);
      }
    }
    // A cell is a thick line, a little longer than it is wide: no gap shows between neighbours.
    const std::string cell = "h" + sim::plain_number(plot_width_ / cells_[0] + overlap, 2);
    const std::string height = " stroke-width=\"" + sim::plain_number(plot_height_ / cells_[1] + overlap, 2) + "\"";
    svg.begin_group("map");
    for (std::size_t number = 0; number < colour_count; ++number) {
      svg.marks(starts[number], cell, colour_style("stroke", number) + height);
    }
    svg.end_group();
  }

  /// The cells around the centroids, of two axes.
  void draw_regions(Svg& svg, std::span<const GaitMap::Elite> elites, const Axis& scale) const {
    svg.rectangle(plot_corner(0, 0), plot_width_, plot_height_, empty_style);
    svg.begin_group("map");
    for (const GaitMap::Elite& elite : elites) {
      Polyline corners;
      for (const auto& [across, up] : map_.tessellation()->corners(elite.cell)) {
        corners.push_back(at_shares(across, up));
      }
      const std::size_t number = colour_of(elite, scale);
      svg.polygon(corners, colour_style("fill", number) + " " + colour_style("stroke", number) + " stroke-width=\"" +
                               sim::plain_number(overlap, 2) + "\"");
    }
    svg.end_group();
  }

  /// A dot at each centroid, seen along axes 3 and 4: where several are at a place, the best is in front.
  void draw_dots(Svg& svg, std::span<const GaitMap::Elite> elites, const Axis& scale) const {
    svg.rectangle(plot_corner(0, 0), plot_width_, plot_height_, empty_style);
    const Objective& objective = experiment_.objectives.front();
    std::vector<GaitMap::Elite> order(elites.begin(), elites.end());
    std::ranges::stable_sort(order, std::greater<>(),
                             [&](const GaitMap::Elite& elite) { return objective.cost(elite.score); });
    svg.begin_group("map");
    for (const GaitMap::Elite& elite : order) {
      svg.circle(middle_of(elite.cell), dot_radius, colour_style("fill", colour_of(elite, scale)));
    }
    svg.end_group();
  }

  [[nodiscard]] Point middle_of(std::size_t cell) const {
    if (map_.tessellation() != nullptr) {
      const std::span<const double> centroid = map_.tessellation()->centroid(cell);
      return at_shares(centroid[0], centroid[1]);
    }
    const Point left = start(map_.place(cell));
    return {left.x + plot_width_ / cells_[0] / 2.0, left.y};
  }

  /// Of a plot without columns and rows; shares of axes 1 and 2.
  [[nodiscard]] Point at_shares(double across, double up) const {
    const Point corner = plot_corner(0, 0);
    return {corner.x + across * plot_width_, corner.y + (1.0 - up) * plot_height_};
  }

  [[nodiscard]] Point plot_corner(std::uint32_t column, std::uint32_t row) const {
    return {sim::page_left + column * (plot_width_ + gap), map_bottom - plot_height_ - row * (plot_height_ + gap)};
  }
  /// The middle of a cell's left edge.
  [[nodiscard]] Point start(std::vector<std::uint32_t> place) const {
    place.resize(cells_.size(), 0);
    const Point plot = plot_corner(place[2], place[3]);
    return {plot.x + plot_width_ * place[0] / cells_[0], plot.y + plot_height_ * (1.0 - (place[1] + 0.5) / cells_[1])};
  }

  void draw_names(Svg& svg) const {
    const MapAxis& across = experiment_.axes[0];
    const MapAxis& up = experiment_.axes[1];
    const Axis x{across.lowest, across.highest, sim::page_left, sim::page_left + plot_width_};
    const Axis y{up.lowest, up.highest, map_bottom, map_bottom - plot_height_};
    for (const double value : sim::multiples(x.low, x.high, sim::nice_step((x.high - x.low) / most(plot_width_, 70)))) {
      svg.line({x.pixel(value), map_bottom}, {x.pixel(value), map_bottom + 4.0}, R"(stroke="#777777")");
      svg.text({x.pixel(value), map_bottom + 18.0}, sim::plain_number(value, 6), sim::TextAnchor::middle,
               sim::label_size, sim::faint_ink);
    }
    for (const double value :
         sim::multiples(y.low, y.high, sim::nice_step((y.high - y.low) / most(plot_height_, 40)))) {
      svg.line({sim::page_left - 4.0, y.pixel(value)}, {sim::page_left, y.pixel(value)}, R"(stroke="#777777")");
      svg.text({sim::page_left - 8.0, y.pixel(value) + 4.0}, sim::plain_number(value, 6), sim::TextAnchor::end,
               sim::label_size, sim::faint_ink);
    }
    svg.text({(sim::page_left + map_right) / 2.0, map_bottom + 40.0},
             axis_text(experiment_, 0) + repeated(2, "columns"), sim::TextAnchor::middle, sim::label_size, sim::ink);
    svg.text({sim::page_left, sim::first_panel_top - 12.0}, axis_text(experiment_, 1) + repeated(3, "rows"),
             sim::TextAnchor::start, sim::label_size, sim::ink);
  }

  static double most(double pixels, double for_each) { return std::max(1.0, std::floor(pixels / for_each)); }

  /// "; columns: slip from 0 to 3".
  [[nodiscard]] std::string repeated(std::size_t axis, const char* what) const {
    if (axis >= experiment_.axes.size()) {
      return {};
    }
    const MapAxis& its = experiment_.axes[axis];
    return std::string("; ") + (map_.tessellation() == nullptr ? what : "seen along") + ": " +
           axis_text(experiment_, axis) + " from " + rounded_text(its.lowest) + " to " + rounded_text(its.highest);
  }

  static constexpr double dot_radius = 4.0;

  const Experiment& experiment_;
  const GaitMap& map_;
  std::array<std::uint32_t, max_map_axes> cells_{1, 1, 1, 1};
  double plot_width_;
  double plot_height_;
};

void draw_colours(Svg& svg, const Axis& scale, std::string_view name) {
  const double left = map_right + 24.0;
  const double height = (map_bottom - sim::first_panel_top) / colour_count;
  for (std::size_t number = 0; number < colour_count; ++number) {
    svg.rectangle({left, map_bottom - (static_cast<double>(number) + 1.0) * height}, bar_width, height,
                  colour_style("fill", number));
  }
  for (const double value : sim::multiples(scale.low, scale.high, sim::nice_step((scale.high - scale.low) / 6.0))) {
    svg.text({left + bar_width + 6.0, scale.pixel(value) + 4.0}, sim::plain_number(value, 6), sim::TextAnchor::start,
             sim::label_size, sim::faint_ink);
  }
  svg.text({sim::page_right, sim::first_panel_top - 12.0}, name, sim::TextAnchor::end, sim::label_size, sim::ink);
}

Axis colour_scale(std::span<const GaitMap::Elite> elites) {
  double lowest = 0.0;
  double highest = 0.0;
  if (!elites.empty()) {
    const auto [min, max] = std::ranges::minmax(elites, {}, &GaitMap::Elite::score);
    lowest = drawable(min.score);
    highest = drawable(max.score);
  }
  return sim::axis_over(lowest, highest, map_bottom, sim::first_panel_top);
}

void draw_small(Svg& svg, double top, const Polyline& line, std::string_view name) {
  const double end = line.empty() ? 1.0 : line.back().x;
  double highest = 0.0;
  for (const Point& point : line) {
    highest = std::max(highest, point.y);
  }
  const Axis x{0.0, std::max(end, 1.0), sim::page_left, sim::page_right};
  const Axis y = sim::axis_over(0.0, highest, top + small_height, top);
  sim::draw_plot_grid(svg, x, y, "evaluations", name);
  svg.polyline(sim::to_pixels(line, x, y), curve_style);
  sim::draw_plot_frame(svg, x, y);
}

}  // namespace

std::string draw_gait_map(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  GaitMap map(experiment);
  Polyline coverage;
  Polyline qd_score;
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    map.add(i, evaluations[i].scores);
    const auto number = static_cast<double>(i + 1);
    coverage.push_back({number, 100.0 * map.coverage()});
    qd_score.push_back({number, drawable(map.qd_score())});
  }
  const Axis scale = colour_scale(map.elites());
  const Objective& objective = experiment.objectives.front();

  Svg svg(sim::page_width, map_page_height, experiment.title(),
          "A map of gaits: the best score of each cell over measures of the run.");
  std::array<char, 96> subtitle{};
  std::snprintf(subtitle.data(), subtitle.size(), "%zu of %zu cells filled (%.1f %%), QD score %s, %zu evaluations",
                map.elites().size(), map.cells(), 100.0 * map.coverage(), rounded_text(map.qd_score()).c_str(),
                evaluations.size());
  sim::draw_title(svg, experiment.title(), subtitle.data());
  MapPlot(experiment, map).draw(svg, map.elites(), scale);
  draw_colours(svg, scale, with_unit(objective.name, objective.unit()));
  const double first_small = map_bottom + small_gap;
  draw_small(svg, first_small, coverage, "filled cells (%)");
  draw_small(svg, first_small + small_height + small_gap, qd_score, "QD score");
  return svg.finish();
}

std::string draw_map_with_trials(const Experiment& experiment, std::span<const GaitMap::Elite> cells,
                                 std::span<const std::size_t> tried, std::size_t best, std::string_view subtitle) {
  const GaitMap map(experiment);
  const Axis scale = colour_scale(cells);
  const Objective& objective = experiment.objectives.front();
  Svg svg(sim::page_width, map_bottom + 56.0, experiment.title(),
          "A map of gaits: what is expected of each cell after trials, whose numbers are on their cells.");
  sim::draw_title(svg, experiment.title(), subtitle);
  const MapPlot plot(experiment, map);
  plot.draw(svg, cells, scale);
  draw_colours(svg, scale, "expected " + with_unit(objective.name, objective.unit()));
  std::map<std::size_t, std::string> numbers;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    std::string& text = numbers[tried[i]];
    text += (text.empty() ? "" : ",") + std::to_string(i + 1);
  }
  svg.begin_group("trials");
  for (const auto& [cell, text] : numbers) {
    plot.mark(svg, cell, text, !tried.empty() && cell == tried[best]);
  }
  svg.end_group();
  return svg.finish();
}

}  // namespace proleg::optimize
