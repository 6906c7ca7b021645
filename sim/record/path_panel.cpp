#include "sim/record/figure_panels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "sim/record/plot_frame.hpp"

namespace proleg::sim {
namespace {

constexpr double max_height_on_page = 320.0;
constexpr double min_height_on_page = 110.0;

struct Extent {
  Point low{INFINITY, INFINITY};
  Point high{-INFINITY, -INFINITY};
  void include(const Polyline& trace, const PathView& view) {
    for (const Point& point : trace) {
      const Point p = view.across(point);
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
};

Extent extent_of(const FigureContents& contents, const PathView& view) {
  Extent extent;
  extent.include(contents.path, view);
  extent.include(contents.first_chain, view);
  extent.include(contents.last_chain, view);
  return extent;
}

double displacement_m(const Recording& recording, const FigureContents& contents) {
  for (const auto& [name, value] : recording.results()) {
    if (name == "displacement_m") {
      return std::strtod(value.c_str(), nullptr);
    }
  }
  return std::hypot(contents.path.back().x - contents.path.front().x, contents.path.back().y - contents.path.front().y);
}

void draw_path_axes(Svg& svg, const PathPanel& panel) {
  const double bottom = panel.top + panel.height;
  const double scale = (page_right - page_left) / (panel.x.high - panel.x.low);
  const double x_step = nice_step(60.0 / scale);
  for (const double value : multiples(panel.x.low, panel.x.high, x_step)) {
    const double x = panel.x.pixel(value);
    svg.line({x, panel.top}, {x, bottom}, grid_style);
    svg.line({x, bottom}, {x, bottom + 5.0}, R"(stroke="#777777")");
    svg.text({x, bottom + 19.0}, plain_number(value, 6), TextAnchor::middle, label_size, ink);
  }
  const double y_step = nice_step(26.0 / scale);
  for (const double value : multiples(panel.y.low, panel.y.high, y_step)) {
    const double y = panel.y.pixel(value);
    svg.line({page_left, y}, {page_right, y}, grid_style);
    svg.text({page_left - 8.0, y + 4.0}, plain_number(panel.view.turned ? -value : value, 6), TextAnchor::end,
             label_size, ink);
  }
  svg.text({(page_left + page_right) / 2.0, bottom + 37.0}, panel.view.turned ? "y (m)" : "x (m)", TextAnchor::middle,
           label_size, ink);
  svg.text({34.0, panel.top + panel.height / 2.0 + 4.0}, panel.view.turned ? "x (m)" : "y (m)", TextAnchor::middle,
           label_size, ink);
}

void draw_chain(Svg& svg, const PathPanel& panel, const Polyline& chain) {
  const Polyline pixels = panel.pixels(chain);
  svg.begin_group("chain");
  svg.polyline(pixels, R"(stroke="#9a9a9a" stroke-width="2" stroke-linecap="round")");
  for (std::size_t link = 0; link < pixels.size(); ++link) {
    svg.circle(pixels[link], link == 0 ? 5.0 : 2.8, R"(fill="#9a9a9a")");
  }
  svg.end_group();
}

/// Dots on the path at full seconds, with their times, as far apart as texts need.
void draw_times(Svg& svg, const FigureContents& contents, const PathPanel& panel) {
  constexpr double min_distance = 46.0;  // pixels
  const double begin = contents.path_from_s;
  const double end = begin + static_cast<double>(contents.path.size() - 1) * contents.tick_s;
  const auto place = [&](double time_s) {
    const auto tick = static_cast<std::size_t>(std::lround((time_s - begin) / contents.tick_s));
    return panel.pixel(contents.path[std::min(tick, contents.path.size() - 1)]);
  };
  const auto far_enough = [](Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y) >= min_distance; };
  const Point last = place(end);
  Point before = place(begin);
  for (const double time_s : multiples(begin, end, nice_step((end - begin) / 12.0))) {
    const Point here = place(time_s);
    svg.circle(here, 2.6, R"(class="time" fill="#ffffff" stroke="#0072b2" stroke-width="1.4")");
    if (far_enough(here, before) && far_enough(here, last)) {
      svg.text({here.x, here.y - 8.0}, plain_number(time_s, 3) + " s", TextAnchor::middle, 11.0, faint_ink,
               R"(stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke")");
      before = here;
    }
  }
}

void draw_mark(Svg& svg, Point center, double name_height, std::string_view name, std::string_view style) {
  svg.circle(center, 5.0, style);
  svg.text({center.x, center.y + name_height}, name, TextAnchor::middle, label_size, ink,
           R"(font-weight="bold" stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke")");
}

}  // namespace

Polyline PathPanel::pixels(const Polyline& trace) const {
  constexpr double resolution = 0.25;
  Polyline result;
  for (const Point& point : trace) {
    const Point p = pixel(point);
    if (result.empty() || std::hypot(p.x - result.back().x, p.y - result.back().y) >= resolution) {
      result.push_back(p);
    }
  }
  return result;
}

PathPanel make_path_panel(const FigureContents& contents, double top) {
  PathView view;
  Extent extent = extent_of(contents, view);
  if (extent.high.y - extent.low.y > extent.high.x - extent.low.x) {
    view.turned = true;
    extent = extent_of(contents, view);
  }
  constexpr double border = 34.0;  // room for the marks and their names
  const double width_m = std::max(extent.high.x - extent.low.x, 0.01);
  const double height_m = extent.high.y - extent.low.y;
  const double max_height = max_height_on_page - 2.0 * border;
  const double scale =
      std::min((page_right - page_left - 2.0 * border) / width_m, height_m > 0.0 ? max_height / height_m : INFINITY);
  const double height = std::max(height_m * scale + 2.0 * border, min_height_on_page);
  const Point center{(extent.low.x + extent.high.x) / 2.0, (extent.low.y + extent.high.y) / 2.0};
  const double half_width_m = (page_right - page_left) / 2.0 / scale;
  const double half_height_m = height / 2.0 / scale;
  return {view,
          {center.x - half_width_m, center.x + half_width_m, page_left, page_right},
          {center.y - half_height_m, center.y + half_height_m, top + height, top},
          top,
          height};
}

void draw_path(Svg& svg, const Recording& recording, const FigureContents& contents, const PathPanel& panel) {
  draw_heading(svg, panel.top, "Path of the chain's centre, from above");
  const double duration = recording.time_s(recording.last_tick());
  svg.text({page_right, panel.top - 12.0},
           "displacement " + plain_number(displacement_m(recording, contents), 3) + " m in " +
               plain_number(duration, 3) + " s",
           TextAnchor::end, heading_size, ink, R"(font-weight="bold")");
  draw_path_axes(svg, panel);
  draw_chain(svg, panel, contents.first_chain);
  draw_chain(svg, panel, contents.last_chain);
  svg.begin_group("path");
  svg.polyline(panel.pixels(contents.path),
               R"(stroke="#0072b2" stroke-width="2" stroke-linejoin="round" stroke-linecap="round")");
  svg.end_group();
  draw_times(svg, contents, panel);
  draw_mark(svg, panel.pixel(contents.path.front()), -11.0, "start",
            R"(fill="#ffffff" stroke="#0072b2" stroke-width="2")");
  draw_mark(svg, panel.pixel(contents.path.back()), 19.0, "end", R"(fill="#0072b2" stroke="#0072b2" stroke-width="2")");
  svg.rectangle({page_left, panel.top}, page_right - page_left, panel.height, frame_style);
  svg.text({page_right, panel.top + panel.height + 37.0}, "grey: the links at start and end, the head larger",
           TextAnchor::end, label_size, faint_ink);
}

}  // namespace proleg::sim
