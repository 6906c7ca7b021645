#include "sim/record/figure_contents.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/measure/stride.hpp"
#include "sim/robot/attached_sensor.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {
namespace {

double bounded(double value) { return std::clamp(value, -1e9, 1e9); }

/// Three strides at the end of the run, 1 to 20 s; 3 s if the joints do not swing.
double default_window_s(const Recording& recording, std::uint32_t last) {
  constexpr double longest_s = 20.0;
  constexpr double strides = 3.0;
  const double tick_s = recording.tick_period_us() / 1e6;
  const auto ticks = static_cast<std::uint32_t>(longest_s / tick_s);
  const std::uint32_t first = std::max(recording.first_tick(), last > ticks ? last - ticks : 0U);
  std::vector<double> targets;
  recording.read_ticks(first, last, [&](const RecordedTick& tick) {
    for (const std::int32_t setpoint : tick.setpoints) {
      targets.push_back(setpoint * (std::numbers::pi / 2.0) / (1U << 30U));
    }
  });
  const auto stride = find_stride({targets, recording.joints().size()}, tick_s);
  return stride ? std::clamp(strides / stride->frequency, 1.0, longest_s) : 3.0;
}

void set_window(const Recording& recording, const TimeWindow& window, FigureContents& contents) {
  const double tick_s = recording.tick_period_us() / 1e6;
  const double begin = recording.time_s(recording.first_tick()) - tick_s;
  const double end = recording.time_s(recording.last_tick());
  if (window.from_s && *window.from_s >= end) {
    throw InputError("--from", 0, number_text(*window.from_s) + " s",
                     "a time before the end of the recording, " + number_text(end) + " s");
  }
  if (window.to_s && *window.to_s <= begin) {
    throw InputError("--to", 0, number_text(*window.to_s) + " s",
                     "a time after the start of the recording, " + number_text(begin) + " s");
  }
  if (window.from_s && window.to_s && *window.from_s >= *window.to_s) {
    throw InputError("--from", 0, number_text(*window.from_s) + " s",
                     "a time before --to, " + number_text(*window.to_s) + " s");
  }
  contents.to_s = std::min(window.to_s.value_or(end), end);
  if (window.from_s) {
    contents.from_s = std::max(*window.from_s, begin);
  } else {
    const double last_tick =
        std::clamp(contents.to_s / tick_s - 1.0, 1.0 * recording.first_tick(), 1.0 * recording.last_tick());
    contents.from_s =
        std::max(contents.to_s - default_window_s(recording, static_cast<std::uint32_t>(last_tick)), begin);
  }
  std::uint32_t first = recording.last_tick();
  std::uint32_t last = recording.first_tick();
  if (contents.from_s < contents.to_s) {
    // Tick k holds at (k + 1) tick_s; the tolerance includes ticks that lie on an end of the window.
    const double tolerance = 1e-6;
    first = static_cast<std::uint32_t>(std::max(std::ceil(contents.from_s / tick_s - 1.0 - tolerance), 0.0));
    last = static_cast<std::uint32_t>(std::max(std::floor(contents.to_s / tick_s - 1.0 + tolerance), 0.0));
    first = std::max(first, recording.first_tick());
  }
  if (last <= first) {
    throw InputError(recording.path().string(), 0,
                     "fewer than two ticks between " + plain_number(window.from_s.value_or(contents.from_s), 6) +
                         " s and " + plain_number(window.to_s.value_or(contents.to_s), 6) + " s",
                     "a window within the recorded " + plain_number(begin, 6) + " s to " + plain_number(end, 6) + " s");
  }
  contents.first_tick = first;
  contents.last_tick = last;
}

Point from_above(const Eigen::Vector3d& position) { return {bounded(position.x()), bounded(position.y())}; }

/// The line of the chain, from the head's front to the tail's rear end.
Polyline chain_of(const std::vector<Pose>& poses, const RobotModel* robot) {
  Polyline chain;
  for (std::size_t link = 0; link < poses.size(); ++link) {
    if (robot == nullptr) {
      chain.push_back(from_above(poses[link].position));
      continue;
    }
    const Pose& model = robot->links[link].pose;
    const LinkEnds ends = link_ends(*robot, link);
    const auto place = [&](const Eigen::Vector3d& in_robot) {
      return from_above(poses[link] * (model.orientation.conjugate() * (in_robot - model.position)));
    };
    if (link == 0) {
      chain.push_back(place(ends.front));
    }
    chain.push_back(place(ends.rear));
  }
  return chain;
}

}  // namespace

FigureContents collect_figure_contents(const Recording& recording, const TimeWindow& window, const RobotModel* robot) {
  FigureContents contents;
  set_window(recording, window, contents);
  contents.tick_s = recording.tick_period_us() / 1e6;
  contents.path_from_s = recording.time_s(recording.first_tick());
  contents.setpoints.resize(recording.joints().size());
  contents.angles.resize(recording.joints().size());
  contents.presses.resize(recording.links().size());

  const auto add_angles = [&contents](const RecordedTick& tick, double time) {
    for (std::size_t joint = 0; joint < contents.setpoints.size(); ++joint) {
      contents.setpoints[joint].push_back({time, tick.setpoints[joint] * 45.0 / (1U << 29U)});
      contents.angles[joint].push_back({time, bounded(tick.joint_angles[joint] * 180.0 / std::numbers::pi)});
    }
  };
  for (const RecordedSensor& sensor : recording.sensors()) {
    contents.sensors.resize(contents.sensors.size() + quantities_of(sensor.kind).size());
  }
  const auto add_sensors = [&](const RecordedTick& tick, double time) {
    std::size_t number = 0;
    for (const RecordedSensor& sensor : recording.sensors()) {
      const auto channels = std::span(tick.sensor_values).subspan(sensor.first_value, sensor.channels.size());
      for (std::size_t quantity = 0; quantity < quantities_of(sensor.kind).size(); ++quantity) {
        contents.sensors[number++].push_back({time, bounded(quantity_of(sensor.kind, quantity, channels))});
      }
    }
  };
  // Contacts hold from the SYNC at which they were latched until the next.
  const auto add_contacts = [&contents](const RecordedTick& tick, double sync_time) {
    const double from = std::max(sync_time, contents.from_s);
    const double to = std::min(sync_time + contents.tick_s, contents.to_s);
    if (from >= to) {
      return;
    }
    for (std::size_t link = 0; link < contents.presses.size(); ++link) {
      for (unsigned sensor = 0; sensor < 2; ++sensor) {
        if (((tick.latched_contacts[link] >> sensor) & 1U) == 0) {
          continue;
        }
        std::vector<FigureContents::Press>& presses = contents.presses[link][sensor];
        if (!presses.empty() && from - presses.back().to_s < contents.tick_s / 2.0) {
          presses.back().to_s = to;
        } else {
          presses.push_back({from, to});
        }
      }
    }
  };
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const RecordedTick& tick) {
    Point sum;
    for (const Pose& pose : tick.link_poses) {
      const Point position = from_above(pose.position);
      sum = {sum.x + position.x, sum.y + position.y};
    }
    const auto links = static_cast<double>(tick.link_poses.size());
    contents.path.push_back({sum.x / links, sum.y / links});
    if (tick.tick == recording.first_tick()) {
      contents.first_chain = chain_of(tick.link_poses, robot);
    }
    if (tick.tick == recording.last_tick()) {
      contents.last_chain = chain_of(tick.link_poses, robot);
    }
    if (tick.tick >= contents.first_tick && tick.tick <= contents.last_tick) {
      add_angles(tick, recording.time_s(tick.tick));
      add_sensors(tick, recording.time_s(tick.tick));
    }
    add_contacts(tick, recording.sync_time_s(tick.tick));
  });
  return contents;
}

}  // namespace proleg::sim
