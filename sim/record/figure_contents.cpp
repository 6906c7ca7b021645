#include "sim/record/figure_contents.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::sim {
namespace {

double bounded(double value) { return std::clamp(value, -1e9, 1e9); }

void set_window(const Recording& recording, const TimeWindow& window, FigureContents& contents) {
  constexpr double default_window_s = 3.0;
  const double tick_s = recording.tick_period_us() / 1e6;
  const double begin = recording.time_s(recording.first_tick()) - tick_s;
  const double end = recording.time_s(recording.last_tick());
  contents.to_s = std::min(window.to_s.value_or(end), end);
  contents.from_s = std::max(window.from_s.value_or(contents.to_s - default_window_s), begin);
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

}  // namespace

FigureContents collect_figure_contents(const Recording& recording, const TimeWindow& window) {
  FigureContents contents;
  set_window(recording, window, contents);
  contents.tick_s = recording.tick_period_us() / 1e6;
  contents.setpoints.resize(recording.joints().size());
  contents.angles.resize(recording.joints().size());
  contents.presses.resize(recording.links().size());

  const auto add_angles = [&contents](const RecordedTick& tick, double time) {
    for (std::size_t joint = 0; joint < contents.setpoints.size(); ++joint) {
      contents.setpoints[joint].push_back({time, tick.setpoints[joint] * 45.0 / (1U << 29U)});
      contents.angles[joint].push_back({time, bounded(tick.joint_angles[joint] * 180.0 / std::numbers::pi)});
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
    Polyline chain;
    Point sum;
    for (const Pose& pose : tick.link_poses) {
      chain.push_back({bounded(pose.position.x()), bounded(pose.position.y())});
      sum = {sum.x + chain.back().x, sum.y + chain.back().y};
    }
    const auto links = static_cast<double>(chain.size());
    contents.path.push_back({sum.x / links, sum.y / links});
    if (tick.tick == recording.first_tick()) {
      contents.first_chain = chain;
    }
    if (tick.tick == recording.last_tick()) {
      contents.last_chain = chain;
    }
    if (tick.tick >= contents.first_tick && tick.tick <= contents.last_tick) {
      add_angles(tick, recording.time_s(tick.tick));
    }
    add_contacts(tick, recording.sync_time_s(tick.tick));
  });
  return contents;
}

}  // namespace proleg::sim
