#include "tools/proleg/document/recording_document.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/gait/declaration.hpp"
#include "sim/record/marks.hpp"
#include "sim/record/recorded_run.hpp"
#include "sim/record/recorded_scenario.hpp"
#include "sim/scenario/names.hpp"
#include "tools/proleg/document/robot_document.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

// The time line has no room for more marks: they would be one bar.
constexpr std::uint32_t max_loss_marks = 200;

/// An event at a tick, for the time line.
struct Mark {
  std::uint64_t tick;
  const char* kind;
  std::string text;
};

json marks_json(const sim::Recording& recording) {
  std::vector<Mark> marks;
  for (const sim::ChangeMark& mark : sim::collect_change_marks(recording)) {
    const long tick = std::lround(mark.time_s * 1e6 / recording.tick_period_us());
    marks.push_back({static_cast<std::uint64_t>(tick), "change", mark.text});
  }
  for (const sim::RecordedFault& fault : recording.faults()) {
    marks.push_back({fault.start_us / recording.tick_period_us(), "fault", fault.text});
  }
  for (const sim::RecordedRestart& restart : recording.restarts()) {
    const std::string& joint = recording.joints()[restart.joint].name;
    marks.push_back({restart.tick, "restart", joint + (restart.joined ? " joined" : " stopped")});
  }
  for (const sim::RobotMove& move : recording.moves()) {
    marks.push_back({move.tick, "move", "moved by hand"});
  }
  for (const sim::RecordedLosses& lost : recording.losses_in_parts(max_loss_marks)) {
    marks.push_back({lost.tick, "loss",
                     std::to_string(lost.frames) + (lost.frames == 1 ? " frame" : " frames") + " lost from here on"});
  }
  std::ranges::stable_sort(marks, {}, &Mark::tick);
  json document = json::array();
  for (const Mark& mark : marks) {
    document.push_back({{"kind", mark.kind}, {"tick", mark.tick}, {"text", mark.text}});
  }
  return document;
}

bool has_slots_of(const sim::Recording& recording, const sim::Scenario& scenario) {
  return std::ranges::all_of(recording.slots(), [&](const sim::RecordedSlot& recorded) {
    const ActuationModule* const algorithm = scenario.kernel.slots[recorded.slot].algorithm;
    return algorithm != nullptr && algorithm->declaration().name == recorded.algorithm;
  });
}

bool has_internal_values_of(const sim::Recording& recording, const sim::Scenario& scenario) {
  const std::vector<sim::RecordedInternalValue>& recorded = recording.internal_values();
  std::size_t next = 0;
  bool fits = true;
  sim::for_each_internal_value(scenario.kernel, [&](unsigned slot, unsigned joint, unsigned number) {
    const std::string_view name = scenario.kernel.slots[slot].algorithm->declaration().internal_values[number].name;
    fits = fits && next < recorded.size() && recorded[next].slot == slot && recorded[next].joint == joint &&
           recorded[next].name == name;
    ++next;
  });
  return fits && next == recorded.size();
}

}  // namespace

json recording_document(const sim::Recording& recording) {
  json results = json::array();
  for (const auto& [name, value] : recording.results()) {
    results.push_back({{"name", name}, {"value", value}});
  }
  return {{"file", recording.path().filename().string()},
          {"program", recording.run_value("program")},
          {"build_id", recording.run_value("build_id")},
          {"core_fingerprint", recording.run_value("core_fingerprint")},
          {"seed", recording.run_value("seed")},
          {"finished", recording.finished()},
          {"first_tick", recording.first_tick()},
          {"last_tick", recording.last_tick()},
          {"has_path", has_path(recording)},
          {"results", std::move(results)},
          {"marks", marks_json(recording)}};
}

bool has_path(const sim::Recording& recording) { return recording.has_world(); }

json recorded_parameters_document(const sim::Recording& recording, const sim::Scenario& scenario) {
  ParameterTable table(scenario, scenario);
  for (const sim::RecordedSetting& setting : recording.parameters()) {
    if (setting.commit) {
      continue;
    }
    const auto parameters = scenario.kernel.slots[setting.slot].algorithm->declaration().parameters;
    const auto found = std::ranges::find(parameters, setting.name, &Parameter::name);
    if (found != parameters.end()) {
      const ParameterPlace place{static_cast<std::uint8_t>(setting.slot), static_cast<std::uint8_t>(setting.joint),
                                 static_cast<std::uint8_t>(found - parameters.begin())};
      table.want(place, setting.raw);
      table.confirm(place, setting.raw, 0);
    }
  }
  return parameters_document(scenario, table);
}

sim::Scenario scenario_of(const sim::Recording& recording, const sim::Overrides& overrides) {
  std::optional<sim::Scenario> scenario = sim::recorded_scenario(recording, overrides);
  if (!scenario || !has_slots_of(recording, *scenario) || !has_internal_values_of(recording, *scenario)) {
    throw InputError(recording.path().string(), 0, "a scenario that this program cannot read",
                     "a recording of this version of Proleg");
  }
  return std::move(*scenario);
}

}  // namespace proleg::tools
