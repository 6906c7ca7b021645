#include "sim/record/figure.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/record/figure_contents.hpp"
#include "sim/record/figure_panels.hpp"
#include "sim/record/marks.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/recorded_scenario.hpp"
#include "sim/record/svg.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {
namespace {

constexpr double between_panels = 44.0;

/// Places of the panels over time, in pixels.
struct Layout {
  std::vector<AnglePanel> angles;
  std::optional<double> losses_top;  ///< nothing if no state frame was lost
  std::vector<SensorPanel> sensors;
  double contacts_top;
  double contacts_height;
};

struct Band {
  double top;
  double height;
};

std::vector<Band> bands_of(const Layout& layout) {
  std::vector<Band> bands;
  for (const AnglePanel& panel : layout.angles) {
    bands.push_back({panel.top, panel.height});
  }
  if (layout.losses_top) {
    bands.push_back({*layout.losses_top, loss_panel_height});
  }
  for (const SensorPanel& panel : layout.sensors) {
    bands.push_back({panel.top, panel.height});
  }
  bands.push_back({layout.contacts_top, layout.contacts_height});
  return bands;
}

/// Joints that bend the robot up and down, and those that bend it to the sides, have a panel each.
Layout make_layout(const Recording& recording, const std::optional<Scenario>& scenario, const FigureContents& contents,
                   bool has_losses, double top) {
  std::vector<std::size_t> pitch;
  std::vector<std::size_t> yaw;
  for (std::size_t joint = 0; joint < recording.joints().size(); ++joint) {
    const bool is_yaw = scenario && direction_of(scenario->robot.joints[joint]) == JointDirection::yaw;
    (is_yaw ? yaw : pitch).push_back(joint);
  }
  Layout layout{{}, std::nullopt, {}, top, contact_panel_height(recording)};
  const auto add = [&layout](const char* what, std::vector<std::size_t> joints) {
    layout.angles.push_back(make_angle_panel(what, std::move(joints), layout.contacts_top));
    layout.contacts_top += layout.angles.back().height + between_panels;
  };
  if (!pitch.empty()) {
    add(yaw.empty() ? "Joint angles" : "Angles of the pitch joints", std::move(pitch));
  }
  if (!yaw.empty()) {
    add("Angles of the yaw joints", std::move(yaw));
  }
  if (has_losses) {
    layout.losses_top = layout.contacts_top;
    layout.contacts_top += loss_panel_height + between_panels;
  }
  layout.sensors = make_sensor_panels(recording, contents, layout.contacts_top, between_panels);
  if (!layout.sensors.empty()) {
    layout.contacts_top = layout.sensors.back().top + layout.sensors.back().height + between_panels;
  }
  return layout;
}

/// The time axis of all panels: grid in each, numbers below the lowest.
void draw_time_axis(Svg& svg, const Axis& time, const Layout& layout) {
  const double bottom = layout.contacts_top + layout.contacts_height;
  const double step = nice_step((time.high - time.low) / 10.0);
  for (const double value : multiples(time.low, time.high, step)) {
    const double x = time.pixel(value);
    for (const Band& band : bands_of(layout)) {
      svg.line({x, band.top}, {x, band.top + band.height}, grid_style);
    }
    svg.line({x, bottom}, {x, bottom + 5.0}, R"(stroke="#777777")");
    svg.text({x, bottom + 19.0}, plain_number(value, 6), TextAnchor::middle, label_size, ink);
  }
  svg.text({(page_left + page_right) / 2.0, bottom + 37.0}, "time (s)", TextAnchor::middle, label_size, ink);
}

/// A line through the panels at each change in the window, labelled where there is room.
void draw_changes(Svg& svg, const std::vector<ChangeMark>& marks, const Axis& time, const Layout& layout) {
  constexpr double character_width = 6.6;  // generous, at the size of labels
  double free_from = page_left;
  for (const ChangeMark& mark : marks) {
    if (mark.time_s < time.low || mark.time_s > time.high) {
      continue;
    }
    const double x = time.pixel(mark.time_s);
    constexpr const char* style = R"(class="change" stroke="#222222" stroke-width="1" stroke-dasharray="2 3")";
    for (const Band& band : bands_of(layout)) {
      svg.line({x, band.top}, {x, band.top + band.height}, style);
    }
    const std::string text = shortened(mark.text, 40);
    const double width = character_width * static_cast<double>(text.size());
    const bool to_the_left = x + width > page_right;
    if ((to_the_left ? x - width : x) >= free_from) {
      svg.text({to_the_left ? x - 4.0 : x + 4.0, layout.angles.front().top + 14.0}, text,
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

void draw_head(Svg& svg, const Recording& recording, std::size_t changes, const Disturbances& disturbances) {
  std::string about = shortened(recording.path().filename().string(), 24) + ": ";
  if (const std::string robot = recording.run_value("robot"); robot != "robot") {
    about += "robot " + shortened(robot, 24) + ", ";
  }
  about += std::to_string(recording.joints().size()) + " joints, seed " + recording.run_value("seed");
  if (changes > 0) {
    about += changes == 1 ? ", changed once in flight" : ", changed " + std::to_string(changes) + " times in flight";
  }
  if (const std::size_t restarts = disturbances.restarts.size(); restarts > 0) {
    about += ", " + std::to_string(restarts) + (restarts == 1 ? " restart" : " restarts");
  }
  if (const std::size_t faults = disturbances.faults.size(); faults > 0) {
    about += ", " + std::to_string(faults) + (faults == 1 ? " fault" : " faults");
  }
  if (!disturbances.lost_in_ticks.empty()) {
    about += ", state frames lost";
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
  const std::optional<Scenario> scenario = recorded_scenario(recording);
  const FigureContents contents = collect_figure_contents(recording, window, scenario ? &scenario->robot : nullptr);
  RobotViews views{{}, {}, first_panel_top};
  if (scenario) {
    views = make_robot_views(recording, contents, *scenario, first_panel_top);
  }
  const Disturbances disturbances = collect_disturbances(recording);
  const Layout layout = make_layout(recording, scenario, contents, !disturbances.lost_in_ticks.empty(), views.bottom);
  const PathPanel panel = make_path_panel(contents, layout.contacts_top + layout.contacts_height + 84.0);

  Svg svg(page_width, panel.top + panel.height + 52.0, scenario_name(recording),
          "The robot in a stride, joint angles and contacts over time, and the path of the robot from above.");
  const std::vector<ChangeMark> changes = collect_change_marks(recording);
  draw_head(svg, recording, changes.size(), disturbances);
  if (scenario) {
    draw_robot_views(svg, *scenario, views);
  }
  const Axis time{contents.from_s, contents.to_s, page_left, page_right};
  draw_time_axis(svg, time, layout);
  for (const AnglePanel& angles : layout.angles) {
    draw_faults(svg, disturbances, time, angles.top, angles.height);
    draw_angles(svg, recording, contents, angles, time);
    draw_restarts(svg, disturbances, time, angles.top, angles.height);
  }
  if (layout.losses_top) {
    draw_loss_panel(svg, recording, disturbances, *layout.losses_top, time);
  }
  for (const SensorPanel& sensors : layout.sensors) {
    draw_sensors(svg, sensors, time);
  }
  draw_contact_panel(svg, recording, contents, layout.contacts_top, time);
  draw_changes(svg, changes, time, layout);
  draw_fault_texts(svg, disturbances, time, layout.angles.front().top);
  draw_path(svg, recording, contents, panel);
  return svg.finish();
}

}  // namespace proleg::sim
