#include "sim/record/figure_panels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/record/plot_frame.hpp"

namespace proleg::sim {
namespace {

constexpr double line_panel_height = 250.0;
constexpr double row_height = 20.0;
constexpr double max_map_height = 330.0;

bool is_map(const AnglePanel& panel) { return panel.joints.size() > distinct_colours.size(); }

std::pair<double, double> range_of(const FigureContents& contents, const AnglePanel& panel) {
  double low = -5.0;
  double high = 5.0;
  for (const std::size_t joint : panel.joints) {
    for (const Polyline* trace : {&contents.setpoints[joint], &contents.angles[joint]}) {
      for (const Point& point : *trace) {
        low = std::min(low, point.y);
        high = std::max(high, point.y);
      }
    }
  }
  return {low, high};
}

Axis angle_axis(const FigureContents& contents, const AnglePanel& panel, double& step) {
  const auto [low, high] = range_of(contents, panel);
  step = std::max(90.0, nice_step((high - low) / 8.0));  // for angles that no robot has
  for (const double candidate : {90.0, 45.0, 30.0, 20.0, 10.0, 5.0, 2.0}) {
    if ((high - low) / candidate <= 8.0) {
      step = candidate;
    }
  }
  const double margin = 0.02 * (high - low);  // for the width of the lines
  return {std::floor((low - margin) / step) * step, std::ceil((high + margin) / step) * step, panel.top + panel.height,
          panel.top};
}

void draw_line_key(Svg& svg, double y) {
  svg.line({page_right - 196.0, y}, {page_right - 168.0, y}, R"(stroke="#222222" stroke-width="2")");
  svg.text({page_right - 162.0, y + 4.0}, "set-point", TextAnchor::start, label_size, ink);
  svg.line({page_right - 92.0, y}, {page_right - 64.0, y},
           R"(stroke="#222222" stroke-width="1.1" stroke-dasharray="5 3")");
  svg.text({page_right, y + 4.0}, "measured", TextAnchor::end, label_size, ink);
}

void draw_lines(Svg& svg, const Recording& recording, const FigureContents& contents, const AnglePanel& panel,
                const Axis& time) {
  double step = 0.0;
  const Axis angle = angle_axis(contents, panel, step);
  draw_line_key(svg, panel.top - 16.0);
  for (const double value : multiples(angle.low, angle.high, step)) {
    const double y = angle.pixel(value);
    svg.line({page_left, y}, {page_right, y}, value == 0.0 ? R"(stroke="#aaaaaa" stroke-width="1")" : grid_style);
    svg.text({page_left - 8.0, y + 4.0}, plain_number(value, 6), TextAnchor::end, label_size, ink);
  }
  std::vector<LineName> names;
  for (std::size_t line = 0; line < panel.joints.size(); ++line) {
    const std::size_t joint = panel.joints[line];
    const std::string colour = std::string("stroke=\"") + distinct_colours[line] + "\" stroke-linejoin=\"round\" ";
    svg.begin_group("joint");
    svg.polyline(to_pixels(contents.setpoints[joint], time, angle), colour + R"(stroke-width="2")");
    svg.polyline(to_pixels(contents.angles[joint], time, angle),
                 colour + R"(stroke-width="1.1" stroke-dasharray="5 3")");
    svg.end_group();
    names.push_back(
        {contents.setpoints[joint].back().y, shortened(recording.joints()[joint].name, 8), distinct_colours[line]});
  }
  draw_line_names(svg, angle, page_right, names);
}

/// Levels of the map on each side of 0.
constexpr int levels = 8;

/// The colour of a level: from blue (the largest negative angle) over white to orange.
std::string level_colour(int level) {
  constexpr std::array<double, 3> negative{0, 90, 150};
  constexpr std::array<double, 3> positive{200, 80, 0};
  const double share = std::abs(level) / static_cast<double>(levels);
  const std::array<double, 3>& end = level < 0 ? negative : positive;
  std::string colour = "rgb(";
  for (std::size_t i = 0; i < 3; ++i) {
    colour += (i > 0 ? "," : "") + plain_number(255.0 + share * (end[i] - 255.0), 0);
  }
  return colour + ")";
}

void draw_map_key(Svg& svg, double y, double largest) {
  constexpr double width = 9.0;
  const double left = page_right - 60.0 - (2 * levels + 1) * width;
  svg.text({left - 6.0, y + 4.0}, plain_number(-largest, 0), TextAnchor::end, label_size, ink);
  for (int level = -levels; level <= levels; ++level) {
    svg.rectangle({left + (level + levels) * width, y - 6.0}, width, 12.0,
                  "fill=\"" + level_colour(level) + "\" stroke=\"#bbbbbb\" stroke-width=\"0.5\"");
  }
  svg.text({page_right - 54.0, y + 4.0}, plain_number(largest, 0) + " deg", TextAnchor::start, label_size, ink);
}

/// One row of the map: neighbours of one colour are one rectangle.
void draw_row(Svg& svg, const Polyline& angles, double tick_s, double largest, const Axis& time, double top,
              double height) {
  const auto level_of = [largest](double angle) {
    return static_cast<int>(std::lround(std::clamp(angle / largest, -1.0, 1.0) * levels));
  };
  std::size_t first = 0;
  for (std::size_t i = 1; i <= angles.size(); ++i) {
    if (i < angles.size() && level_of(angles[i].y) == level_of(angles[first].y)) {
      continue;
    }
    const double from = time.pixel(std::max(angles[first].x - tick_s, time.low));
    const double to = time.pixel(std::min(angles[i - 1].x, time.high));
    const std::string colour = level_colour(level_of(angles[first].y));
    std::string style = "stroke-width=\"0.3\" fill=\"";
    style.append(colour).append("\" stroke=\"").append(colour).append("\"");
    svg.rectangle({from, top}, to - from, height, style);
    first = i;
  }
}

void draw_map(Svg& svg, const Recording& recording, const FigureContents& contents, const AnglePanel& panel,
              const Axis& time) {
  const auto [low, high] = range_of(contents, panel);
  const double largest = std::max(-low, high);
  draw_map_key(svg, panel.top - 16.0, largest);
  const double row = panel.height / static_cast<double>(panel.joints.size());
  const auto every = static_cast<std::size_t>(std::ceil(14.0 / row));
  for (std::size_t line = 0; line < panel.joints.size(); ++line) {
    const std::size_t joint = panel.joints[line];
    const double top = panel.top + row * static_cast<double>(line);
    svg.begin_group("joint");
    draw_row(svg, contents.angles[joint], contents.tick_s, largest, time, top, row);
    svg.end_group();
    if (line % every == 0) {
      svg.text({page_left - 8.0, top + row / 2.0 + 4.0}, shortened(recording.joints()[joint].name, 11), TextAnchor::end,
               label_size, ink);
    }
  }
}

}  // namespace

AnglePanel make_angle_panel(std::string what, std::vector<std::size_t> joints, double top) {
  AnglePanel panel{std::move(what), std::move(joints), top, line_panel_height};
  if (is_map(panel)) {
    panel.height = std::min(row_height * static_cast<double>(panel.joints.size()), max_map_height);
    panel.heading += ", measured";
  } else {
    panel.heading += " (deg)";
  }
  return panel;
}

void draw_angles(Svg& svg, const Recording& recording, const FigureContents& contents, const AnglePanel& panel,
                 const Axis& time) {
  draw_heading(svg, panel.top, panel.heading);
  if (is_map(panel)) {
    draw_map(svg, recording, contents, panel, time);
  } else {
    draw_lines(svg, recording, contents, panel, time);
  }
  svg.rectangle({page_left, panel.top}, page_right - page_left, panel.height, frame_style);
}

}  // namespace proleg::sim
