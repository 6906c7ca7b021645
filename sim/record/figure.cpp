#include "sim/record/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/record/axis.hpp"
#include "sim/record/svg.hpp"
#include "sim/scenario/input_error.hpp"

namespace proleg::sim {
namespace {

// Page, in pixels.
constexpr double page_width = 900.0;
constexpr double left = 104.0;
constexpr double right = 820.0;
constexpr double angle_panel_top = 104.0;
constexpr double angle_panel_height = 250.0;
constexpr double contact_panel_top = angle_panel_top + angle_panel_height + 44.0;
constexpr double most_contact_panel_height = 320.0;
constexpr double most_path_panel_height = 320.0;
constexpr double least_path_panel_height = 110.0;

constexpr double label_size = 12.0;
constexpr double heading_size = 13.5;
constexpr const char* ink = "#222222";
constexpr const char* faint_ink = "#555555";
constexpr const char* grid_style = R"(stroke="#e2e2e2" stroke-width="1")";
constexpr const char* frame_style = R"(fill="none" stroke="#777777" stroke-width="1")";

/// A trace over time, or a path.
using Trace = std::vector<Point>;

/// What is drawn, taken from the recording in one pass.
struct Contents {
  double from_s = 0.0;
  double to_s = 0.0;
  double tick_s = 0.0;
  std::vector<Trace> setpoints;  ///< per joint; x: s, y: degrees
  std::vector<Trace> angles;
  struct Press {
    double from_s;
    double to_s;
  };
  std::vector<std::array<std::vector<Press>, 2>> presses;  ///< per link: of the rear and the front sensor
  Trace path;                                              ///< x, y of the centre, in m
  Trace first_chain;                                       ///< x, y of the links, head to tail
  Trace last_chain;
};

std::pair<std::uint32_t, std::uint32_t> ticks_in(const Recording& recording, const TimeWindow& window,
                                                 Contents& contents) {
  constexpr double default_window_s = 3.0;
  const double tick_s = recording.tick_period_us() / 1e6;
  const double begin = recording.time_s(recording.first_tick()) - tick_s;
  const double end = recording.time_s(recording.last_tick());
  contents.to_s = std::min(window.to_s.value_or(end), end);
  contents.from_s = std::max(window.from_s.value_or(contents.to_s - default_window_s), begin);
  std::uint32_t first = recording.last_tick();
  std::uint32_t last = recording.first_tick();
  if (contents.from_s < contents.to_s) {
    // Tick k holds at (k + 1) tick_s; the tolerance takes in ticks that lie on an end of the window.
    const double tolerance = 1e-6;
    first = static_cast<std::uint32_t>(std::max(std::ceil(contents.from_s / tick_s - 1.0 - tolerance), 0.0));
    last = static_cast<std::uint32_t>(std::max(std::floor(contents.to_s / tick_s - 1.0 + tolerance), 0.0));
    first = std::max(first, recording.first_tick());
  }
  if (last <= first) {
    throw InputError(recording.path().string(), 0,
                     "less than two ticks between " + plain_number(window.from_s.value_or(contents.from_s), 6) +
                         " s and " + plain_number(window.to_s.value_or(contents.to_s), 6) + " s",
                     "a window within the recorded " + plain_number(begin, 6) + " s to " + plain_number(end, 6) + " s");
  }
  return {first, last};
}

Contents collect(const Recording& recording, const TimeWindow& window) {
  Contents contents;
  const auto [first, last] = ticks_in(recording, window, contents);
  contents.tick_s = recording.tick_period_us() / 1e6;
  contents.setpoints.resize(recording.joints().size());
  contents.angles.resize(recording.joints().size());
  contents.presses.resize(recording.links().size());

  const auto add_angles = [&contents](const RecordedTick& tick, double time) {
    for (std::size_t joint = 0; joint < contents.setpoints.size(); ++joint) {
      contents.setpoints[joint].push_back({time, tick.setpoints[joint] * 45.0 / (1U << 29U)});
      contents.angles[joint].push_back({time, tick.joint_angles[joint] * 180.0 / std::numbers::pi});
    }
  };
  const auto add_contacts = [&contents](const RecordedTick& tick, double time) {
    const double from = std::max(time - contents.tick_s / 2.0, contents.from_s);
    const double to = std::min(time + contents.tick_s / 2.0, contents.to_s);
    for (std::size_t link = 0; link < contents.presses.size(); ++link) {
      for (unsigned sensor = 0; sensor < 2; ++sensor) {
        if (((tick.link_contacts[link] >> sensor) & 1U) == 0) {
          continue;
        }
        std::vector<Contents::Press>& presses = contents.presses[link][sensor];
        if (!presses.empty() && from - presses.back().to_s < contents.tick_s / 2.0) {
          presses.back().to_s = to;
        } else {
          presses.push_back({from, to});
        }
      }
    }
  };
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const RecordedTick& tick) {
    Trace chain;
    Point sum;
    for (const Pose& pose : tick.link_poses) {
      chain.push_back({pose.position.x(), pose.position.y()});
      sum = {sum.x + pose.position.x(), sum.y + pose.position.y()};
    }
    const auto links = static_cast<double>(chain.size());
    contents.path.push_back({sum.x / links, sum.y / links});
    if (tick.tick == recording.first_tick()) {
      contents.first_chain = chain;
    }
    if (tick.tick == recording.last_tick()) {
      contents.last_chain = chain;
    }
    if (tick.tick >= first && tick.tick <= last) {
      add_angles(tick, recording.time_s(tick.tick));
      add_contacts(tick, recording.time_s(tick.tick));
    }
  });
  return contents;
}

/// Colours that people with any colour vision tell apart (M. Okabe, K. Ito, 2008; without the yellow, which is too
/// faint on white); for more joints a scale from blue to orange with falling lightness in between, head to tail.
std::string joint_colour(std::size_t joint, std::size_t count) {
  constexpr std::array<const char*, 7> distinct{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#000000"};
  if (count <= distinct.size()) {
    return distinct[joint];
  }
  using Colour = std::array<double, 3>;
  constexpr std::array<Colour, 3> scale{Colour{0, 114, 178}, Colour{60, 60, 70}, Colour{213, 94, 0}};
  const double place = 2.0 * static_cast<double>(joint) / static_cast<double>(count - 1);
  const std::size_t half = place < 1.0 ? 0 : 1;
  const double share = place - static_cast<double>(half);
  std::string colour = "rgb(";
  for (std::size_t i = 0; i < 3; ++i) {
    colour += (i > 0 ? "," : "") + plain_number(scale[half][i] + share * (scale[half + 1][i] - scale[half][i]), 0);
  }
  return colour + ")";
}

/// In pixels, with at most four points (first, lowest, highest, last) in each column of pixels, so that a picture of an
/// hour is no larger than one of a minute and no peak is lost.
Trace to_pixels(const Trace& trace, const Axis& x, const Axis& y) {
  Trace pixels;
  std::vector<Point> column;
  const auto flush = [&] {
    if (column.size() <= 4) {
      pixels.insert(pixels.end(), column.begin(), column.end());
    } else {
      const auto lower = [](const Point& a, const Point& b) { return a.y < b.y; };
      auto [low, high] = std::minmax_element(column.begin() + 1, column.end() - 1, lower);
      if (high < low) {
        std::swap(low, high);
      }
      pixels.insert(pixels.end(), {column.front(), *low, *high, column.back()});
    }
    column.clear();
  };
  for (const Point& point : trace) {
    const Point pixel{x.pixel(point.x), y.pixel(point.y)};
    if (!column.empty() && std::floor(pixel.x) != std::floor(column.front().x)) {
      flush();
    }
    column.push_back(pixel);
  }
  flush();
  return pixels;
}

void heading(Svg& svg, double panel_top, std::string_view text) {
  svg.text({left, panel_top - 12.0}, text, TextAnchor::start, heading_size, ink, R"(font-weight="bold")");
}

/// The time axis of two panels one above the other: grid in both, numbers below the lower.
void draw_time_axis(Svg& svg, const Axis& time, double contact_panel_height) {
  const double bottom = contact_panel_top + contact_panel_height;
  const double step = nice_step((time.high - time.low) / 10.0);
  for (const double value : multiples(time.low, time.high, step)) {
    const double x = time.pixel(value);
    svg.line({x, angle_panel_top}, {x, angle_panel_top + angle_panel_height}, grid_style);
    svg.line({x, contact_panel_top}, {x, bottom}, grid_style);
    svg.line({x, bottom}, {x, bottom + 5.0}, R"(stroke="#777777")");
    svg.text({x, bottom + 19.0}, plain_number(value, 6), TextAnchor::middle, label_size, ink);
  }
  svg.text({(left + right) / 2.0, bottom + 37.0}, "time (s)", TextAnchor::middle, label_size, ink);
}

Axis angle_axis(const Contents& contents, double& step) {
  double low = -5.0;
  double high = 5.0;
  for (const std::vector<Trace>* traces : {&contents.setpoints, &contents.angles}) {
    for (const Trace& trace : *traces) {
      for (const Point& point : trace) {
        low = std::min(low, point.y);
        high = std::max(high, point.y);
      }
    }
  }
  step = 90.0;
  for (const double candidate : {45.0, 30.0, 20.0, 10.0, 5.0, 2.0}) {
    if ((high - low) / candidate <= 8.0) {
      step = candidate;
    }
  }
  const double margin = 0.02 * (high - low);  // for the width of the lines
  return {std::floor((low - margin) / step) * step, std::ceil((high + margin) / step) * step,
          angle_panel_top + angle_panel_height, angle_panel_top};
}

void draw_angle_key(Svg& svg) {
  const double y = angle_panel_top - 16.0;
  svg.line({right - 228.0, y}, {right - 200.0, y}, R"(stroke="#222222" stroke-width="2")");
  svg.text({right - 194.0, y + 4.0}, "set-point", TextAnchor::start, label_size, ink);
  svg.line({right - 118.0, y}, {right - 90.0, y}, R"(stroke="#222222" stroke-width="1.1" stroke-dasharray="5 3")");
  svg.text({right, y + 4.0}, "measured", TextAnchor::end, label_size, ink);
}

void draw_angles(Svg& svg, const Recording& recording, const Contents& contents, const Axis& time) {
  double step = 0.0;
  const Axis angle = angle_axis(contents, step);
  heading(svg, angle_panel_top, "Joint angles (deg)");
  draw_angle_key(svg);
  for (const double value : multiples(angle.low, angle.high, step)) {
    const double y = angle.pixel(value);
    svg.line({left, y}, {right, y}, value == 0.0 ? R"(stroke="#aaaaaa" stroke-width="1")" : grid_style);
    svg.text({left - 8.0, y + 4.0}, plain_number(value, 6), TextAnchor::end, label_size, ink);
  }

  const std::size_t count = recording.joints().size();
  for (std::size_t joint = 0; joint < count; ++joint) {
    const std::string colour = "stroke=\"" + joint_colour(joint, count) + "\" stroke-linejoin=\"round\" ";
    svg.begin_group("joint");
    svg.polyline(to_pixels(contents.setpoints[joint], time, angle), colour + R"(stroke-width="2")");
    svg.polyline(to_pixels(contents.angles[joint], time, angle),
                 colour + R"(stroke-width="1.1" stroke-dasharray="5 3")");
    svg.end_group();
  }
  svg.rectangle({left, angle_panel_top}, right - left, angle_panel_height, frame_style);

  // Each line is labelled where it ends. If there are too many, the first and every n-th.
  constexpr double gap = 15.0;
  const auto most = static_cast<std::size_t>(angle_panel_height / gap);
  const std::size_t every = (count + most - 1) / most;
  std::vector<double> ends;
  for (std::size_t joint = 0; joint < count; joint += every) {
    ends.push_back(angle.pixel(contents.setpoints[joint].back().y));
  }
  const std::vector<double> places =
      spread(ends, gap, angle_panel_top + 4.0, angle_panel_top + angle_panel_height - 4.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string colour = joint_colour(i * every, count);
    svg.line({right, ends[i]}, {right + 12.0, places[i]}, "stroke=\"" + colour + "\" stroke-width=\"1\"");
    svg.text({right + 15.0, places[i] + 4.0}, recording.joints()[i * every].name, TextAnchor::start, label_size, colour,
             R"(font-weight="bold")");
  }
}

double contact_row_height(std::size_t links) {
  return std::min(22.0, most_contact_panel_height / static_cast<double>(links));
}

void draw_contacts(Svg& svg, const Recording& recording, const Contents& contents, const Axis& time) {
  const std::size_t links = recording.links().size();
  const double row = contact_row_height(links);
  const double height = row * static_cast<double>(links);
  heading(svg, contact_panel_top, "Contacts with the ground");
  svg.text({right, contact_panel_top - 12.0}, "in each row: front sensor above, rear sensor below", TextAnchor::end,
           label_size, faint_ink);
  const auto every = static_cast<std::size_t>(std::ceil(14.0 / row));
  for (std::size_t link = 0; link < links; ++link) {
    const double top = contact_panel_top + row * static_cast<double>(link);
    if (link > 0) {
      svg.line({left, top}, {right, top}, grid_style);
    }
    if (link % every == 0) {
      svg.text({left - 8.0, top + row / 2.0 + 4.0}, recording.links()[link], TextAnchor::end, label_size, ink);
    }
    const double bar = row * 0.36;
    for (unsigned sensor = 0; sensor < 2; ++sensor) {
      const double y = sensor == 1 ? top + row / 2.0 - bar - row * 0.03 : top + row / 2.0 + row * 0.03;
      for (const Contents::Press& press : contents.presses[link][sensor]) {
        const double x = time.pixel(press.from_s);
        svg.rectangle({x, y}, time.pixel(press.to_s) - x, bar,
                      sensor == 1 ? R"(class="contact" fill="#444444")" : R"(class="contact" fill="#8a8a8a")");
      }
    }
  }
  svg.rectangle({left, contact_panel_top}, right - left, height, frame_style);
}

/// Which way the world is turned on the page: the longer way of the robot lies across it.
struct View {
  bool turned = false;  ///< y to the right and x down, instead of x to the right and y up
  [[nodiscard]] Point across(Point world) const { return turned ? Point{world.y, -world.x} : world; }
};

struct Extent {
  Point low{INFINITY, INFINITY};
  Point high{-INFINITY, -INFINITY};
  void include(const Trace& trace, const View& view) {
    for (const Point& point : trace) {
      const Point p = view.across(point);
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
};

Extent extent_of(const Contents& contents, const View& view) {
  Extent extent;
  extent.include(contents.path, view);
  extent.include(contents.first_chain, view);
  extent.include(contents.last_chain, view);
  return extent;
}

double displacement_m(const Recording& recording, const Contents& contents) {
  for (const auto& [name, value] : recording.results()) {
    if (name == "displacement_m") {
      return std::strtod(value.c_str(), nullptr);
    }
  }
  return std::hypot(contents.path.back().x - contents.path.front().x, contents.path.back().y - contents.path.front().y);
}

/// The panel in which one metre is as long across as upwards.
struct PathPanel {
  View view;
  Axis x;
  Axis y;
  double top;
  double height;

  [[nodiscard]] Point pixel(Point world) const {
    const Point p = view.across(world);
    return {x.pixel(p.x), y.pixel(p.y)};
  }
  [[nodiscard]] Trace pixels(const Trace& trace) const {
    // What lies closer together than this cannot be seen.
    constexpr double resolution = 0.25;
    Trace result;
    for (const Point& point : trace) {
      const Point p = pixel(point);
      if (result.empty() || std::hypot(p.x - result.back().x, p.y - result.back().y) >= resolution) {
        result.push_back(p);
      }
    }
    return result;
  }
};

PathPanel make_path_panel(const Contents& contents, double top) {
  View view;
  Extent extent = extent_of(contents, view);
  if (extent.high.y - extent.low.y > extent.high.x - extent.low.x) {
    view.turned = true;
    extent = extent_of(contents, view);
  }
  constexpr double border = 34.0;  // room for the marks and their names
  const double width_m = std::max(extent.high.x - extent.low.x, 0.01);
  const double height_m = extent.high.y - extent.low.y;
  const double most_height = most_path_panel_height - 2.0 * border;
  const double scale =
      std::min((right - left - 2.0 * border) / width_m, height_m > 0.0 ? most_height / height_m : INFINITY);
  const double height = std::max(height_m * scale + 2.0 * border, least_path_panel_height);
  const Point center{(extent.low.x + extent.high.x) / 2.0, (extent.low.y + extent.high.y) / 2.0};
  const double half_width_m = (right - left) / 2.0 / scale;
  const double half_height_m = height / 2.0 / scale;
  return {view,
          {center.x - half_width_m, center.x + half_width_m, left, right},
          {center.y - half_height_m, center.y + half_height_m, top + height, top},
          top,
          height};
}

void draw_path_axes(Svg& svg, const PathPanel& panel) {
  const double bottom = panel.top + panel.height;
  const double scale = (right - left) / (panel.x.high - panel.x.low);
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
    svg.line({left, y}, {right, y}, grid_style);
    svg.text({left - 8.0, y + 4.0}, plain_number(panel.view.turned ? -value : value, 6), TextAnchor::end, label_size,
             ink);
  }
  svg.text({(left + right) / 2.0, bottom + 37.0}, panel.view.turned ? "y (m)" : "x (m)", TextAnchor::middle, label_size,
           ink);
  svg.text({34.0, panel.top + panel.height / 2.0 + 4.0}, panel.view.turned ? "x (m)" : "y (m)", TextAnchor::middle,
           label_size, ink);
}

void draw_chain(Svg& svg, const PathPanel& panel, const Trace& chain) {
  const Trace pixels = panel.pixels(chain);
  svg.begin_group("chain");
  svg.polyline(pixels, R"(stroke="#9a9a9a" stroke-width="2" stroke-linecap="round")");
  for (std::size_t link = 0; link < pixels.size(); ++link) {
    svg.circle(pixels[link], link == 0 ? 5.0 : 2.8, R"(fill="#9a9a9a")");
  }
  svg.end_group();
}

void draw_mark(Svg& svg, Point center, double name_height, std::string_view name, std::string_view style) {
  svg.circle(center, 5.0, style);
  svg.text({center.x, center.y + name_height}, name, TextAnchor::middle, label_size, ink,
           R"(font-weight="bold" stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke")");
}

void draw_path(Svg& svg, const Recording& recording, const Contents& contents, const PathPanel& panel) {
  heading(svg, panel.top, "Path of the chain's centre, from above");
  const double duration = recording.time_s(recording.last_tick());
  svg.text({right, panel.top - 12.0},
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
  draw_mark(svg, panel.pixel(contents.path.front()), -11.0, "start",
            R"(fill="#ffffff" stroke="#0072b2" stroke-width="2")");
  draw_mark(svg, panel.pixel(contents.path.back()), 19.0, "end", R"(fill="#0072b2" stroke="#0072b2" stroke-width="2")");
  svg.rectangle({left, panel.top}, right - left, panel.height, frame_style);
  svg.text({right, panel.top + panel.height + 37.0}, "grey: the links at start and end, the head larger",
           TextAnchor::end, label_size, faint_ink);
}

/// "travelling_wave/uniform.simulation.xml" is called "uniform".
std::string scenario_name(const Recording& recording) {
  std::string name = std::filesystem::path(recording.run_value("scenario")).filename().string();
  return name.substr(0, name.find('.'));
}

void draw_title(Svg& svg, const Recording& recording) {
  svg.text({left, 36.0}, scenario_name(recording), TextAnchor::start, 20.0, ink, R"(font-weight="bold")");
  std::string about = "robot " + recording.run_value("robot") + ", " + std::to_string(recording.joints().size()) +
                      " joints, seed " + recording.run_value("seed");
  if (!recording.finished()) {
    about += ", not finished";
  }
  svg.text({left, 58.0}, about, TextAnchor::start, label_size, faint_ink);
  svg.text({right, 58.0}, "proleg " + recording.run_value("build_id"), TextAnchor::end, label_size, faint_ink);
}

}  // namespace

std::string draw_figure(const Recording& recording, const TimeWindow& window) {
  const Contents contents = collect(recording, window);
  const double contact_panel_height =
      contact_row_height(recording.links().size()) * static_cast<double>(recording.links().size());
  const PathPanel panel = make_path_panel(contents, contact_panel_top + contact_panel_height + 84.0);

  Svg svg(page_width, panel.top + panel.height + 52.0, scenario_name(recording),
          "Joint angles and contacts over time, and the path of the robot from above.");
  draw_title(svg, recording);
  const Axis time{contents.from_s, contents.to_s, left, right};
  draw_time_axis(svg, time, contact_panel_height);
  draw_angles(svg, recording, contents, time);
  draw_contacts(svg, recording, contents, time);
  draw_path(svg, recording, contents, panel);
  return svg.finish();
}

}  // namespace proleg::sim
