#include "sim/record/marks.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/record/plot_frame.hpp"

namespace proleg::sim {
namespace {

/// A value that several joints of a module get for the same name.
using Assignment = std::tuple<std::uint32_t, std::string, std::string>;  // slot, name, value

/// As users write it: the half turn, which is the smallest raw value, is 180 and not -180 degrees. (A recording has
/// the same unit for phases and for angles, but only a phase has this value.)
std::string value_text(const RecordedSetting& setting) {
  const std::string text(format_decimal(setting.raw, setting.unit).view());
  const bool is_angle = setting.unit == Unit::degree || setting.unit == Unit::phase_degree;
  return is_angle && setting.raw == std::numeric_limits<std::int32_t>::min() ? text.substr(1) : text;
}

std::string describe(const Recording& recording, const std::map<Assignment, std::set<std::uint32_t>>& assignments) {
  const auto& [assignment, joints] = *assignments.begin();
  const auto& [slot, name, value] = assignment;
  std::string text = name;
  if (joints.size() == 1 && recording.joints().size() > 1) {
    text += " " + recording.joints()[*joints.begin()].name;
  }
  text += " = " + value;
  if (assignments.size() > 1) {
    text += ", +" + std::to_string(assignments.size() - 1);
  }
  return text;
}

}  // namespace

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
  for (const RecordedFault& fault : recording.faults()) {
    const auto to_s = fault.end_us ? std::optional(static_cast<double>(*fault.end_us) * 1e-6) : std::nullopt;
    // The axis shows the time, so the text begins behind "at TIME".
    const std::size_t after_at = fault.text.find(' ', fault.text.find(' ') + 1);
    result.faults.push_back({after_at == std::string::npos ? fault.text : fault.text.substr(after_at + 1),
                             static_cast<double>(fault.start_us) * 1e-6, to_s});
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

void draw_faults(Svg& svg, const Disturbances& disturbances, const Axis& time, double top, double height) {
  for (const Disturbances::FaultMark& fault : disturbances.faults) {
    if (fault.from_s >= time.low && fault.from_s <= time.high) {
      const double x = time.pixel(fault.from_s);
      svg.line({x, top}, {x, top + height}, R"(class="fault" stroke="#b00020" stroke-width="1")");
    }
    const double from = std::max(fault.from_s, time.low);
    const double to = std::min(fault.to_s.value_or(fault.from_s), time.high);
    if (from < to) {
      svg.rectangle({time.pixel(from), top}, std::max(time.pixel(to) - time.pixel(from), 1.5), height,
                    R"(class="fault" fill="#b00020" fill-opacity="0.09")");
    }
  }
}

void draw_fault_texts(Svg& svg, const Disturbances& disturbances, const Axis& time, double top) {
  constexpr double line_height = 13.0;
  constexpr std::size_t max_lines = 6;
  std::size_t line = 0;
  for (const Disturbances::FaultMark& fault : disturbances.faults) {
    if (fault.from_s < time.low || fault.from_s > time.high || line == max_lines) {
      continue;
    }
    const double x = time.pixel(fault.from_s);
    const bool to_the_left = x > (page_left + page_right) / 2.0;
    svg.text({to_the_left ? x - 4.0 : x + 4.0, top + line_height * static_cast<double>(++line)},
             shortened(fault.text, 44), to_the_left ? TextAnchor::end : TextAnchor::start, label_size, "#b00020");
  }
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

std::vector<ChangeMark> collect_change_marks(const Recording& recording) {
  std::map<std::uint32_t, std::map<Assignment, std::set<std::uint32_t>>> by_tick;
  const auto add = [&](const RecordedSetting& setting) {
    by_tick[setting.tick][{setting.slot, setting.name, value_text(setting)}].insert(setting.joint);
  };
  for (const RecordedSetting& setting : recording.parameters()) {
    if (setting.commit) {
      add(setting);
    }
  }
  for (const RecordedSetting& setting : recording.distortions()) {
    add(setting);
  }
  std::vector<ChangeMark> marks;
  marks.reserve(by_tick.size());
  for (const auto& [tick, assignments] : by_tick) {
    marks.push_back({recording.sync_time_s(tick), describe(recording, assignments)});
  }
  return marks;
}

}  // namespace proleg::sim
