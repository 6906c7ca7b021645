#include "sim/record/disturbance_marks.hpp"

#include <algorithm>

#include "shared/computer/text/text.hpp"
#include "sim/record/figure_page.hpp"

namespace proleg::sim {

Disturbances collect_disturbances(const Recording& recording) {
  Disturbances result;
  std::vector<std::optional<std::size_t>> open(recording.joints().size());  // by joint: in result.restarts
  for (const RecordedRestart& event : recording.restarts()) {
    const double time_s = recording.sync_time_s(event.tick);
    if (!event.joined) {
      open[event.joint] = result.restarts.size();
      result.restarts.push_back({recording.joints()[event.joint].name, time_s, std::nullopt});
    } else if (open[event.joint]) {
      result.restarts[*open[event.joint]].to_s = time_s;
      open[event.joint].reset();
    }
  }
  LossReader losses(recording);
  while (const std::optional<Loss> loss = losses.next()) {
    if (result.lost_in_ticks.empty() || result.lost_in_ticks.back().tick != loss->tick) {
      result.lost_in_ticks.push_back({loss->tick, 0});
    }
    ++result.lost_in_ticks.back().frames;
  }
  return result;
}

void draw_restarts(Svg& svg, const Disturbances& disturbances, const Axis& time, double top, double height) {
  for (const Disturbances::Restart& restart : disturbances.restarts) {
    const double from = std::max(restart.from_s, time.low);
    const double to = std::min(restart.to_s.value_or(time.high), time.high);
    if (from >= to) {
      continue;
    }
    const double x = time.pixel(from);
    svg.rectangle({x, top}, std::max(time.pixel(to) - x, 1.5), height,
                  R"(class="restart" fill="#d55e00" fill-opacity="0.16")");
    const bool to_the_left = x > (page_left + page_right) / 2.0;
    svg.text({to_the_left ? x - 4.0 : time.pixel(to) + 4.0, top + height - 10.0},
             shortened(restart.joint, 8) + " restarts", to_the_left ? TextAnchor::end : TextAnchor::start, label_size,
             "#b34700");
  }
}

}  // namespace proleg::sim
