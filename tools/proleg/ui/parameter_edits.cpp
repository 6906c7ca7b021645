#include "tools/proleg/ui/parameter_edits.hpp"

#include <algorithm>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::tools {

ParameterEdits::ParameterEdits(const sim::Scenario& file) : file_(file), scratch_(file), parameters_(file) {
  scratch_.sources.clear();  // they are not needed, and cost time to copy
}

std::vector<sim::Setting> ParameterEdits::set(const std::vector<std::string>& words,
                                              std::optional<std::uint64_t> gesture) {
  if (words.empty()) {
    throw InputError("set", 0, "no word", "NAME=VALUE");
  }
  scratch_.changes.clear();
  for (const std::string& word : words) {
    if (word.find('@') != std::string::npos) {
      throw InputError(shortened(word), 0, "a tick", "NAME=VALUE, which takes effect at once");
    }
    sim::apply_setting(scratch_, word + "@1");
  }
  std::vector<sim::Setting> internal_values;
  ChangeHistory::Entry entry{words.front().substr(0, words.front().find('=')), {}, gesture};
  for (const sim::Setting& setting : scratch_.changes.front().settings) {
    if (setting.internal) {
      internal_values.push_back(setting);
      continue;
    }
    const ParameterPlace place{setting.slot, setting.joint, setting.index};
    entry.steps.push_back({place, parameters_.at(place).wanted, setting.value});
    parameters_.want(place, setting.value);
  }
  if (!entry.steps.empty()) {
    history_.add(std::move(entry));
  }
  return internal_values;
}

bool ParameterEdits::undo() {
  const ChangeHistory::Entry* entry = history_.to_undo();
  if (entry == nullptr) {
    return false;
  }
  for (const ChangeHistory::Step& step : entry->steps) {
    parameters_.want(step.place, step.before);
  }
  history_.undone();
  return true;
}

bool ParameterEdits::redo() {
  const ChangeHistory::Entry* entry = history_.to_redo();
  if (entry == nullptr) {
    return false;
  }
  for (const ChangeHistory::Step& step : entry->steps) {
    parameters_.want(step.place, step.after);
  }
  history_.redone();
  return true;
}

void ParameterEdits::reset(const std::optional<std::vector<std::string>>& names) {
  std::vector<ParameterPlace> places = names ? std::vector<ParameterPlace>() : parameters_.places();
  for (const std::string& name : names.value_or(std::vector<std::string>())) {
    const sim::SettingTarget target = sim::find_target(file_, name + "=0");
    if (target.internal) {
      throw InputError(shortened(name), 0, "an internal value", "a parameter");
    }
    for (const unsigned joint : target.joints) {
      places.push_back({static_cast<std::uint8_t>(target.slot), static_cast<std::uint8_t>(joint),
                        static_cast<std::uint8_t>(target.index)});
    }
  }
  ChangeHistory::Entry entry{"reset", {}, std::nullopt};
  for (const ParameterPlace& place : places) {
    const ParameterTable::Values& values = parameters_.at(place);
    if (values.wanted != values.file) {
      entry.steps.push_back({place, values.wanted, values.file});
      parameters_.want(place, values.file);
    }
  }
  if (!entry.steps.empty()) {
    history_.add(std::move(entry));
  }
}

bool ParameterEdits::differs_from_file() const {
  return std::ranges::any_of(parameters_.places(), [this](const ParameterPlace& place) {
    return parameters_.at(place).wanted != parameters_.at(place).file;
  });
}

sim::Scenario ParameterEdits::scenario_as_wanted() const {
  sim::Scenario scenario = file_;
  for (const ParameterPlace& place : parameters_.places()) {
    sim::set_start_value(scenario, {place.slot, place.joint, place.index, false, parameters_.at(place).wanted});
  }
  return scenario;
}

}  // namespace proleg::tools
