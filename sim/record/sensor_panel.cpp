#include "sim/record/sensor_panel.hpp"

#include <algorithm>
#include <limits>

#include "shared/computer/text/text.hpp"
#include "sim/record/figure_page.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/robot/sensor_quantity.hpp"

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

}  // namespace proleg::sim
