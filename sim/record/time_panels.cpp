#include "sim/record/figure_panels.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/robot/attached_sensor.hpp"

namespace proleg::sim {
namespace {

constexpr double sensor_panel_height = 130.0;

std::string heading_of(SensorKind kind) {
  switch (kind) {
    case SensorKind::touch:
      return "Attached touch sensors (1: pressed)";
    case SensorKind::laser:
      return "Laser scanners: the nearest (m)";
    case SensorKind::servo_current:
      return "Servo currents (mA)";
    case SensorKind::inclinometer:
      return "Inclinometers (deg)";
    case SensorKind::accelerometer:
      break;
  }
  return "Accelerometers (m/s^2)";
}

/// A joint on which two slots broadcast sends two frames in a tick, any other joint one. All other joints receive them.
double receptions_in_a_tick(const Recording& recording) {
  const std::size_t joints = recording.joints().size();
  std::size_t frames = 0;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    std::size_t broadcasts = 0;
    for (const RecordedSlot& slot : recording.slots()) {
      const ActuationModule* const algorithm = find_algorithm(slot.algorithm);
      broadcasts +=
          algorithm != nullptr && !algorithm->declaration().frame.empty() && slot.joint_group[joint] ? 1U : 0U;
    }
    frames += std::max<std::size_t>(broadcasts, 1);
  }
  return static_cast<double>(frames * (joints - 1));
}

std::string percent(double share, int decimals) { return plain_number(100.0 * share, decimals) + " %"; }

double contact_row_height(std::size_t links) {
  constexpr double max_panel_height = 320.0;
  return std::min(22.0, max_panel_height / static_cast<double>(links));
}

}  // namespace

std::vector<SensorPanel> make_sensor_panels(const Recording& recording, const FigureContents& contents, double top,
                                            double between) {
  std::vector<SensorPanel> panels;
  for (const SensorKind kind : {SensorKind::touch, SensorKind::laser, SensorKind::servo_current,
                                SensorKind::inclinometer, SensorKind::accelerometer}) {
    SensorPanel panel{heading_of(kind), {}, kind == SensorKind::touch, top, sensor_panel_height};
    std::size_t number = 0;  // of the quantity, over all sensors
    std::size_t left_out = 0;
    for (const RecordedSensor& sensor : recording.sensors()) {
      for (const SensorQuantity& quantity : quantities_of(sensor.kind)) {
        const Polyline& values = contents.sensors[number++];
        if (sensor.kind != kind) {
          continue;
        }
        if (panel.lines.size() == distinct_colours.size()) {
          ++left_out;
          continue;
        }
        const bool has_several = quantities_of(kind).size() > 1;
        panel.lines.push_back({has_several ? shortened(sensor.name, 8) + ' ' + std::string(quantity.name.substr(0, 1))
                                           : shortened(sensor.name, 10),
                               &values});
      }
    }
    if (left_out > 0) {
      panel.heading += ", without " + std::to_string(left_out) + " more";
    }
    if (!panel.lines.empty()) {
      top += panel.height + between;
      panels.push_back(std::move(panel));
    }
  }
  return panels;
}

void draw_sensors(Svg& svg, const SensorPanel& panel, const Axis& time) {
  double low = panel.is_of_switches ? 0.0 : std::numeric_limits<double>::infinity();
  double high = panel.is_of_switches ? 1.0 : -std::numeric_limits<double>::infinity();
  for (const SensorPanel::Line& line : panel.lines) {
    for (const Point& point : *line.values) {
      low = std::min(low, point.y);
      high = std::max(high, point.y);
    }
  }
  const Axis axis = axis_over(low, high, panel.top + panel.height, panel.top);
  draw_heading(svg, panel.top, panel.heading);
  for (const double value : multiples(axis.low, axis.high, nice_step((axis.high - axis.low) / 5.0))) {
    const double y = axis.pixel(value);
    svg.line({page_left, y}, {page_right, y}, grid_style);
    svg.text({page_left - 8.0, y + 4.0}, plain_number(value, 6), TextAnchor::end, label_size, ink);
  }
  std::vector<LineName> names;
  svg.begin_group("sensor");
  for (std::size_t i = 0; i < panel.lines.size(); ++i) {
    const SensorPanel::Line& line = panel.lines[i];
    svg.polyline(to_pixels(*line.values, time, axis),
                 std::string("stroke=\"") + distinct_colours.at(i) + R"(" stroke-width="1.3" stroke-linejoin="round")");
    names.push_back({line.values->back().y, line.name, distinct_colours.at(i)});
  }
  svg.end_group();
  draw_line_names(svg, axis, page_right, names);
  svg.rectangle({page_left, panel.top}, page_right - page_left, panel.height, frame_style);
}

LossShares collect_loss_shares(const Recording& recording, const Disturbances& disturbances, const Axis& time) {
  constexpr double bar_width = 6.0;  // pixels, at least
  const double tick_s = recording.tick_period_us() / 1e6;
  const auto tick_at = [&](double seconds) {
    return static_cast<std::uint32_t>(std::max(std::ceil(seconds / tick_s - 1e-6), 0.0));
  };
  const std::uint32_t first = tick_at(time.low);
  const std::uint32_t end = std::max(tick_at(time.high), first + 1);
  const double pixels_of_tick = time.pixel(time.low + tick_s) - time.pixel(time.low);
  const double receptions = receptions_in_a_tick(recording);

  LossShares shares;
  shares.ticks_of_bar = static_cast<std::uint32_t>(std::max(std::ceil(bar_width / pixels_of_tick - 1e-6), 1.0));
  std::vector<double> lost((end - first + shares.ticks_of_bar - 1) / shares.ticks_of_bar);
  double all = 0.0;
  for (const Disturbances::TickLosses& losses : disturbances.lost_in_ticks) {
    if (losses.tick >= first && losses.tick < end) {
      lost[(losses.tick - first) / shares.ticks_of_bar] += losses.frames;
      all += losses.frames;
    }
  }
  shares.share = all / (receptions * (end - first));
  for (std::uint32_t bar = 0; bar < lost.size(); ++bar) {
    const std::uint32_t from = first + bar * shares.ticks_of_bar;
    const std::uint32_t to = std::min(from + shares.ticks_of_bar, end);
    if (lost[bar] > 0.0) {
      shares.bars.push_back({from, to, std::min(lost[bar] / (receptions * (to - from)), 1.0)});
    }
  }
  return shares;
}

void draw_loss_panel(Svg& svg, const Recording& recording, const Disturbances& disturbances, double top,
                     const Axis& time) {
  const LossShares shares = collect_loss_shares(recording, disturbances, time);
  double highest = 0.01;
  for (const LossShares::Bar& bar : shares.bars) {
    highest = std::max(highest, bar.share);
  }
  const Axis height{0.0, std::min(nice_step(highest), 1.0), top + loss_panel_height, top};
  draw_heading(svg, top, "State frames lost (%)");
  svg.text({page_right, top - 12.0},
           percent(shares.share, 1) + " in this window; each bar: " +
               plain_number(shares.ticks_of_bar * recording.tick_period_us() / 1e3, 3) + " ms",
           TextAnchor::end, label_size, faint_ink);
  for (const double share : {height.low, height.high}) {
    svg.text({page_left - 8.0, height.pixel(share) + 4.0}, plain_number(100.0 * share, 1), TextAnchor::end, label_size,
             ink);
  }
  svg.begin_group("loss");
  for (const LossShares::Bar& bar : shares.bars) {
    const double left = time.pixel(std::max(recording.sync_time_s(bar.first_tick), time.low));
    const double right = time.pixel(std::min(recording.sync_time_s(bar.end_tick), time.high));
    const double y = height.pixel(bar.share);
    svg.rectangle({left, y}, std::max(right - left, 0.5), height.pixel_low - y, R"(fill="#d55e00")");
  }
  svg.end_group();
  svg.rectangle({page_left, top}, page_right - page_left, loss_panel_height, frame_style);
}

double contact_panel_height(const Recording& recording) {
  const std::size_t links = recording.links().size();
  return contact_row_height(links) * static_cast<double>(links);
}

void draw_contact_panel(Svg& svg, const Recording& recording, const FigureContents& contents, double panel_top,
                        const Axis& time) {
  const std::size_t links = recording.links().size();
  const double row = contact_row_height(links);
  draw_heading(svg, panel_top, "Contacts with the ground");
  svg.text({page_right, panel_top - 12.0}, "in each row: front sensor above, rear sensor below", TextAnchor::end,
           label_size, faint_ink);
  const auto every = static_cast<std::size_t>(std::ceil(14.0 / row));
  for (std::size_t link = 0; link < links; ++link) {
    const double top = panel_top + row * static_cast<double>(link);
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
  svg.rectangle({page_left, panel_top}, page_right - page_left, contact_panel_height(recording), frame_style);
}

}  // namespace proleg::sim
