#include "sim/record/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/record/axis.hpp"
#include "sim/record/change_marks.hpp"
#include "sim/record/figure_contents.hpp"
#include "sim/record/figure_page.hpp"
#include "sim/record/path_panel.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {
namespace {

constexpr double angle_panel_height = 250.0;
constexpr double contact_panel_top = first_panel_top + angle_panel_height + 44.0;
constexpr double max_contact_panel_height = 320.0;

/// 1 if the figure shows the angles of all joints; else n for one joint in n, so that the lines remain distinct.
std::size_t joint_stride(std::size_t joints) {
  constexpr std::size_t max_lines = 10;
  return (joints + max_lines - 1) / max_lines;
}

/// distinct_colours; for more lines a scale from blue over grey to orange, head to tail.
std::string line_colour(std::size_t line, std::size_t count) {
  if (count <= distinct_colours.size()) {
    return distinct_colours[line];
  }
  using Colour = std::array<double, 3>;
  constexpr std::array<Colour, 3> scale{Colour{0, 114, 178}, Colour{60, 60, 70}, Colour{213, 94, 0}};
  const double place = 2.0 * static_cast<double>(line) / static_cast<double>(count - 1);
  const std::size_t half = place < 1.0 ? 0 : 1;
  const double share = place - static_cast<double>(half);
  std::string colour = "rgb(";
  for (std::size_t i = 0; i < 3; ++i) {
    colour += (i > 0 ? "," : "") + plain_number(scale[half][i] + share * (scale[half + 1][i] - scale[half][i]), 0);
  }
  return colour + ")";
}

/// The time axis of two panels one above the other: grid in both, numbers below the lower.
void draw_time_axis(Svg& svg, const Axis& time, double contact_panel_height) {
  const double bottom = contact_panel_top + contact_panel_height;
  const double step = nice_step((time.high - time.low) / 10.0);
  for (const double value : multiples(time.low, time.high, step)) {
    const double x = time.pixel(value);
    svg.line({x, first_panel_top}, {x, first_panel_top + angle_panel_height}, grid_style);
    svg.line({x, contact_panel_top}, {x, bottom}, grid_style);
    svg.line({x, bottom}, {x, bottom + 5.0}, R"(stroke="#777777")");
    svg.text({x, bottom + 19.0}, plain_number(value, 6), TextAnchor::middle, label_size, ink);
  }
  svg.text({(page_left + page_right) / 2.0, bottom + 37.0}, "time (s)", TextAnchor::middle, label_size, ink);
}

Axis angle_axis(const FigureContents& contents, double& step) {
  double low = -5.0;
  double high = 5.0;
  for (const std::vector<Polyline>* traces : {&contents.setpoints, &contents.angles}) {
    for (const Polyline& trace : *traces) {
      for (const Point& point : trace) {
        low = std::min(low, point.y);
        high = std::max(high, point.y);
      }
    }
  }
  step = std::max(90.0, nice_step((high - low) / 8.0));  // for angles that no robot has
  for (const double candidate : {90.0, 45.0, 30.0, 20.0, 10.0, 5.0, 2.0}) {
    if ((high - low) / candidate <= 8.0) {
      step = candidate;
    }
  }
  const double margin = 0.02 * (high - low);  // for the width of the lines
  return {std::floor((low - margin) / step) * step, std::ceil((high + margin) / step) * step,
          first_panel_top + angle_panel_height, first_panel_top};
}

void draw_angle_key(Svg& svg) {
  const double y = first_panel_top - 16.0;
  svg.line({page_right - 196.0, y}, {page_right - 168.0, y}, R"(stroke="#222222" stroke-width="2")");
  svg.text({page_right - 162.0, y + 4.0}, "set-point", TextAnchor::start, label_size, ink);
  svg.line({page_right - 92.0, y}, {page_right - 64.0, y},
           R"(stroke="#222222" stroke-width="1.1" stroke-dasharray="5 3")");
  svg.text({page_right, y + 4.0}, "measured", TextAnchor::end, label_size, ink);
}

void draw_angles(Svg& svg, const Recording& recording, const FigureContents& contents, const Axis& time) {
  double step = 0.0;
  const Axis angle = angle_axis(contents, step);
  const std::size_t stride = joint_stride(recording.joints().size());
  draw_heading(svg, first_panel_top,
               stride == 1 ? "Joint angles (deg)" : "Joint angles (deg), one joint in " + std::to_string(stride));
  draw_angle_key(svg);
  for (const double value : multiples(angle.low, angle.high, step)) {
    const double y = angle.pixel(value);
    svg.line({page_left, y}, {page_right, y}, value == 0.0 ? R"(stroke="#aaaaaa" stroke-width="1")" : grid_style);
    svg.text({page_left - 8.0, y + 4.0}, plain_number(value, 6), TextAnchor::end, label_size, ink);
  }

  const std::size_t count = (recording.joints().size() + stride - 1) / stride;
  std::vector<LineName> names;
  for (std::size_t line = 0; line < count; ++line) {
    const std::size_t joint = line * stride;
    const std::string colour = "stroke=\"" + line_colour(line, count) + "\" stroke-linejoin=\"round\" ";
    svg.begin_group("joint");
    svg.polyline(to_pixels(contents.setpoints[joint], time, angle), colour + R"(stroke-width="2")");
    svg.polyline(to_pixels(contents.angles[joint], time, angle),
                 colour + R"(stroke-width="1.1" stroke-dasharray="5 3")");
    svg.end_group();
    names.push_back(
        {contents.setpoints[joint].back().y, shortened(recording.joints()[joint].name, 8), line_colour(line, count)});
  }
  svg.rectangle({page_left, first_panel_top}, page_right - page_left, angle_panel_height, frame_style);

  draw_line_names(svg, angle, page_right, names);
}

double contact_row_height(std::size_t links) {
  return std::min(22.0, max_contact_panel_height / static_cast<double>(links));
}

void draw_contacts(Svg& svg, const Recording& recording, const FigureContents& contents, const Axis& time) {
  const std::size_t links = recording.links().size();
  const double row = contact_row_height(links);
  const double height = row * static_cast<double>(links);
  draw_heading(svg, contact_panel_top, "Contacts with the ground");
  svg.text({page_right, contact_panel_top - 12.0}, "in each row: front sensor above, rear sensor below",
           TextAnchor::end, label_size, faint_ink);
  const auto every = static_cast<std::size_t>(std::ceil(14.0 / row));
  for (std::size_t link = 0; link < links; ++link) {
    const double top = contact_panel_top + row * static_cast<double>(link);
    if (link > 0) {
      svg.line({page_left, top}, {page_right, top}, grid_style);
    }
    if (link % every == 0) {
      svg.text({page_left - 8.0, top + row / 2.0 + 4.0}, shortened(recording.links()[link], 11), TextAnchor::end,
               label_size, ink);
    }
    const double bar = row * 0.36;
    for (unsigned sensor = 0; sensor < 2; ++sensor) {
      const double y = sensor == 1 ? top + row / 2.0 - bar - row * 0.03 : top + row / 2.0 + row * 0.03;
      for (const FigureContents::Press& press : contents.presses[link][sensor]) {
        const double x = time.pixel(press.from_s);
        svg.rectangle({x, y}, time.pixel(press.to_s) - x, bar,
                      sensor == 1 ? R"(class="contact" fill="#444444")" : R"(class="contact" fill="#8a8a8a")");
      }
    }
  }
  svg.rectangle({page_left, contact_panel_top}, page_right - page_left, height, frame_style);
}

/// A line through both panels at each change in the window, labelled where there is room.
void draw_changes(Svg& svg, const std::vector<ChangeMark>& marks, const Axis& time, double contact_panel_height) {
  constexpr double character_width = 6.6;  // generous, at the size of labels
  double free_from = page_left;
  for (const ChangeMark& mark : marks) {
    if (mark.time_s < time.low || mark.time_s > time.high) {
      continue;
    }
    const double x = time.pixel(mark.time_s);
    constexpr const char* style = R"(class="change" stroke="#222222" stroke-width="1" stroke-dasharray="2 3")";
    svg.line({x, first_panel_top}, {x, first_panel_top + angle_panel_height}, style);
    svg.line({x, contact_panel_top}, {x, contact_panel_top + contact_panel_height}, style);
    const std::string text = shortened(mark.text, 40);
    const double width = character_width * static_cast<double>(text.size());
    const bool to_the_left = x + width > page_right;
    if ((to_the_left ? x - width : x) >= free_from) {
      svg.text({to_the_left ? x - 4.0 : x + 4.0, first_panel_top + 14.0}, text,
               to_the_left ? TextAnchor::end : TextAnchor::start, label_size, ink);
      free_from = to_the_left ? x : x + width;
    }
  }
}

/// "travelling_wave/uniform.simulation.xml" is called "uniform".
std::string scenario_name(const Recording& recording) {
  std::string name = std::filesystem::path(recording.run_value("scenario")).filename().string();
  return name.substr(0, name.find('.'));
}

void draw_head(Svg& svg, const Recording& recording, std::size_t changes) {
  std::string about = "robot " + shortened(recording.run_value("robot"), 24) + ", " +
                      std::to_string(recording.joints().size()) + " joints, seed " + recording.run_value("seed");
  if (changes > 0) {
    about += changes == 1 ? ", changed once in flight" : ", changed " + std::to_string(changes) + " times in flight";
  }
  if (!recording.finished()) {
    about += ", not finished";
  }
  draw_title(svg, shortened(scenario_name(recording), 55), about);
  svg.text({page_right, subtitle_y}, "proleg " + shortened(recording.run_value("build_id"), 32), TextAnchor::end,
           label_size, faint_ink);
}

}  // namespace

std::string draw_figure(const Recording& recording, const TimeWindow& window) {
  const FigureContents contents = collect_figure_contents(recording, window);
  const double contact_panel_height =
      contact_row_height(recording.links().size()) * static_cast<double>(recording.links().size());
  const PathPanel panel = make_path_panel(contents, contact_panel_top + contact_panel_height + 84.0);

  Svg svg(page_width, panel.top + panel.height + 52.0, scenario_name(recording),
          "Joint angles and contacts over time, and the path of the robot from above.");
  const std::vector<ChangeMark> changes = collect_change_marks(recording);
  draw_head(svg, recording, changes.size());
  const Axis time{contents.from_s, contents.to_s, page_left, page_right};
  draw_time_axis(svg, time, contact_panel_height);
  draw_angles(svg, recording, contents, time);
  draw_contacts(svg, recording, contents, time);
  draw_changes(svg, changes, time, contact_panel_height);
  draw_path(svg, recording, contents, panel);
  return svg.finish();
}

}  // namespace proleg::sim
