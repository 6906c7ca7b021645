#include "sim/record/change_marks.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "shared/fixed/decimal.hpp"

namespace proleg::sim {
namespace {

/// The same value for the same name on several joints of a module.
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
