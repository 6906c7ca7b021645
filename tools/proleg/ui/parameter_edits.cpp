#include "tools/proleg/ui/parameter_edits.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/joint_memory.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

std::string number_name(const json& parameter) {
  return std::to_string(parameter.at("slot").get<unsigned>()) + '.' + parameter.at("name").get<std::string>();
}

/// Which value of a parameter belongs to a joint.
std::optional<std::size_t> place_of(std::size_t joint, const json& parameter) {
  const auto joints = parameter.at("joints").get<std::vector<std::size_t>>();
  const auto found = std::ranges::find(joints, joint);
  return found == joints.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - joints.begin()));
}

}  // namespace

bool ParameterWords::is_module(const json& slot, const std::string& module) const {
  if (module == std::to_string(slot.get<unsigned>())) {
    return true;
  }
  return std::ranges::any_of(robot_.value("slots", json::array()), [&](const json& known) {
    return known.at("number") == slot && known.at("algorithm") == module;
  });
}

ParameterWords::Parameter ParameterWords::find(const std::string& name, const std::string& where) const {
  const auto refuse = [&](const std::string& found, const std::string& expected) {
    throw InputError(where + shortened(name), 0, found, expected);
  };
  const sim::SettingName parts = sim::parse_setting_name(name);

  std::vector<const json*> meanings;
  std::vector<std::string> known;
  for (const json& parameter : parameters_) {
    if (parameter.at("internal").get<bool>()) {
      continue;
    }
    known.push_back(number_name(parameter));
    if (parameter.at("name") == parts.name && (!parts.module || is_module(parameter.at("slot"), *parts.module))) {
      meanings.push_back(&parameter);
    }
  }
  if (meanings.empty()) {
    refuse("no such parameter", "one of " + listed(known));
  }

  std::size_t place = 0;
  if (parts.joint) {
    const json joints = robot_.value("joints", json::array());
    const auto named =
        std::ranges::find_if(joints, [&](const json& known_joint) { return known_joint.at("name") == *parts.joint; });
    const auto index = static_cast<std::size_t>(named - joints.begin());
    std::erase_if(meanings, [&](const json* parameter) { return !place_of(index, *parameter); });
    if (meanings.empty()) {
      refuse("joint " + in_quotes(*parts.joint), "one that the module drives");
    }
    place = place_of(index, *meanings.front()).value_or(0);
  }
  if (meanings.size() > 1) {
    std::vector<std::string> names;
    names.reserve(meanings.size());
    std::ranges::transform(meanings, std::back_inserter(names),
                           [](const json* meaning) { return number_name(*meaning); });
    refuse("a name in several modules", "one of " + listed(names));
  }
  const json& parameter = *meanings.front();
  const auto scale = parameter.at("scale").get<double>();
  return {parameter.at("minimum").get<double>() * scale, parameter.at("maximum").get<double>() * scale,
          !parameter.at("wraps").get<bool>(), parameter.at("wanted").at(place).get<double>() * scale, scale};
}

void check_binding(const host::Binding& binding, const ParameterWords& words, const std::string& where) {
  const auto* const target = std::get_if<host::ParameterBinding>(&binding.target);
  if (target == nullptr) {
    return;
  }
  for (const std::string& name : target->parameters) {
    const ParameterWords::Parameter parameter = words.find(name, where + ": ");
    const double slack = parameter.resolution / 2;  // the limits themselves are rounded
    for (const double limit : {target->lower, target->upper}) {
      if (parameter.has_limits && (limit < parameter.minimum - slack || limit > parameter.maximum + slack)) {
        throw InputError(where + ": " + shortened(name), 0, "limit " + number_text(limit),
                         number_text(parameter.minimum) + " to " + number_text(parameter.maximum));
      }
    }
  }
}

void ChangeHistory::add(Entry entry) {
  const bool continues =
      done_ == entries_.size() && done_ > 0 && entry.gesture && entries_.back().gesture == entry.gesture;
  entries_.resize(done_);
  if (!continues) {
    if (entries_.size() == max_entries) {
      entries_.erase(entries_.begin());
    }
    entries_.push_back(std::move(entry));
    done_ = entries_.size();
    return;
  }
  std::vector<Step>& steps = entries_.back().steps;
  for (const Step& step : entry.steps) {
    const auto earlier = std::ranges::find(steps, step.place, &Step::place);
    if (earlier != steps.end()) {
      earlier->after = step.after;
    } else {
      steps.push_back(step);
    }
  }
}

ParameterEdits::ParameterEdits(const sim::Scenario& file, const sim::Scenario& start)
    : file_(file), parameters_(file, start) {}

std::vector<Setting> ParameterEdits::read(const std::vector<std::string>& words) const {
  if (words.empty()) {
    throw InputError("set", 0, "no word", "NAME=VALUE");
  }
  std::vector<Setting> settings;
  for (const std::string& word : words) {
    if (word.find('@') != std::string::npos) {
      throw InputError(shortened(word), 0, "a tick", "NAME=VALUE, which takes effect at once");
    }
    sim::add_settings(file_, sim::parse_setting(file_, word), settings);
  }
  return settings;
}

std::vector<Setting> ParameterEdits::set(const std::vector<std::string>& words, std::optional<std::uint64_t> gesture) {
  std::vector<Setting> settings = read(words);
  ChangeHistory::Entry entry{words.front().substr(0, words.front().find('=')), {}, gesture};
  for (const Setting& setting : settings) {
    if (!setting.internal) {
      const ParameterPlace place = place_of(setting);
      entry.steps.push_back({place, parameters_.at(place).wanted, setting.value});
      parameters_.want(place, setting.value);
    }
  }
  if (!entry.steps.empty()) {
    history_.add(std::move(entry));
  }
  return settings;
}

std::optional<std::vector<Setting>> ParameterEdits::undo() {
  const ChangeHistory::Entry* entry = history_.to_undo();
  if (entry == nullptr) {
    return std::nullopt;
  }
  history_.undone();
  return want(*entry, &ChangeHistory::Step::before);
}

std::optional<std::vector<Setting>> ParameterEdits::redo() {
  const ChangeHistory::Entry* entry = history_.to_redo();
  if (entry == nullptr) {
    return std::nullopt;
  }
  history_.redone();
  return want(*entry, &ChangeHistory::Step::after);
}

std::vector<Setting> ParameterEdits::reset(const std::vector<ParameterPlace>& places) {
  ChangeHistory::Entry entry{"reset", {}, std::nullopt};
  for (const ParameterPlace& place : places) {
    const ParameterTable::Values& values = parameters_.at(place);
    if (values.wanted != values.file) {
      entry.steps.push_back({place, values.wanted, values.file});
    }
  }
  std::vector<Setting> settings = want(entry, &ChangeHistory::Step::after);
  if (!settings.empty()) {
    history_.add(std::move(entry));
  }
  return settings;
}

std::vector<Setting> ParameterEdits::want(const ChangeHistory::Entry& entry, std::int32_t ChangeHistory::Step::*value) {
  std::vector<Setting> settings;
  settings.reserve(entry.steps.size());
  for (const ChangeHistory::Step& step : entry.steps) {
    parameters_.want(step.place, step.*value);
    settings.push_back(setting_of(step.place, step.*value));
  }
  return settings;
}

std::vector<ParameterPlace> ParameterEdits::places_of(const std::optional<std::vector<std::string>>& names) const {
  if (!names) {
    return parameters_.places();
  }
  std::vector<ParameterPlace> places;
  for (const std::string& name : *names) {
    const sim::SettingTarget target = sim::find_named_target(file_, name);
    if (target.internal) {
      throw InputError(shortened(name), 0, "an internal value", "a parameter");
    }
    for (const unsigned joint : target.joints) {
      places.push_back({static_cast<std::uint8_t>(target.slot), static_cast<std::uint8_t>(joint),
                        static_cast<std::uint8_t>(target.number)});
    }
  }
  return places;
}

bool ParameterEdits::differs_from_file() const {
  return std::ranges::any_of(parameters_.places(), [this](const ParameterPlace& place) {
    return parameters_.at(place).wanted != parameters_.at(place).file;
  });
}

sim::Scenario ParameterEdits::scenario_as_wanted() const {
  sim::Scenario scenario = file_;
  for (const ParameterPlace& place : parameters_.places()) {
    sim::set_start_value(scenario, setting_of(place, parameters_.at(place).wanted));
  }
  return scenario;
}

void ChangeDelivery::begin_run() {
  edits_.parameters().begin_run();
  given_.clear();
  for (const ParameterPlace& place : edits_.parameters().places()) {
    given_.push_back(edits_.parameters().at(place).wanted);
  }
  internal_values_.clear();
}

void ChangeDelivery::add(const std::vector<Setting>& internal_values) {
  internal_values_.insert(internal_values_.end(), internal_values.begin(), internal_values.end());
}

std::vector<Setting> ChangeDelivery::next() {
  std::vector<Setting> settings;
  const auto has_room = [&](unsigned joint) {
    return std::ranges::count(settings, joint, &Setting::joint) < static_cast<std::ptrdiff_t>(max_staged_values);
  };
  std::erase_if(internal_values_, [&](const Setting& setting) {
    const bool fits = has_room(setting.joint);
    if (fits) {
      settings.push_back(setting);
    }
    return fits;
  });
  const ParameterTable& table = edits_.parameters();
  const std::vector<ParameterPlace>& places = table.places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::int32_t wanted = table.at(places[i]).wanted;
    if (wanted != given_[i] && has_room(places[i].joint)) {
      settings.push_back(setting_of(places[i], wanted));
      given_[i] = wanted;
    }
  }
  return settings;
}

void ChangeDelivery::confirm(const Change& change) {
  ParameterTable& table = edits_.parameters();
  const std::vector<ParameterPlace>& places = table.places();
  for (const Setting& setting : change.settings) {
    if (setting.internal) {
      continue;
    }
    const ParameterPlace place = place_of(setting);
    table.confirm(place, setting.value, change.tick);
    const auto at = static_cast<std::size_t>(std::ranges::find(places, place) - places.begin());
    if (table.at(place).wanted == given_[at]) {
      table.want(place, setting.value);  // a change of the file
      given_[at] = setting.value;
    }
  }
}

void ChangeDelivery::give_up() {
  ParameterTable& table = edits_.parameters();
  const std::vector<ParameterPlace>& places = table.places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::int32_t confirmed = table.at(places[i]).confirmed;
    if (given_[i] != confirmed) {
      given_[i] = confirmed;
      table.want(places[i], confirmed);
    }
  }
}

}  // namespace proleg::tools
