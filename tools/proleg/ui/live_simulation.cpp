#include "tools/proleg/ui/live_simulation.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/loop/robot_placement.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/robot_move.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/simulation_results.hpp"
#include "tools/proleg/ui/actuation_file.hpp"

namespace proleg::tools {
namespace {

/// The sources are not needed, and cost time to copy.
sim::Scenario without_sources(sim::Scenario scenario) {
  scenario.sources.clear();
  return scenario;
}

ParameterPlace place_of(const sim::Setting& setting) { return {setting.slot, setting.joint, setting.index}; }

sim::Scenario with_settings(sim::Scenario scenario, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    sim::apply_setting(scenario, word);
  }
  return scenario;
}

sim::Setting setting_of(const ParameterPlace& place, std::int32_t value) {
  return {place.slot, place.joint, place.index, false, value};
}

}  // namespace

LiveSimulation::LiveSimulation(sim::Scenario file, std::vector<std::string> settings, const sim::Losses* losses)
    : file_(std::move(file)),
      settings_(std::move(settings)),
      given_(with_settings(file_, settings_)),
      losses_(losses),
      scenario_(given_),
      scratch_(without_sources(file_)),
      parameters_(file_, given_) {
  for (const ParameterPlace& place : parameters_.places()) {
    other_set_.push_back(parameters_.at(place).file);
  }
  begin();
}

std::uint32_t LiveSimulation::set(const std::vector<std::string>& words, std::optional<std::uint64_t> gesture) {
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
  const std::vector<sim::Setting> settings = scratch_.changes.front().settings;
  std::uint32_t tick = std::max(simulation_->tick(), live_.empty() ? 0 : live_.back().tick);
  while (!fits(tick, settings)) {
    ++tick;
  }
  ChangeHistory::Entry entry{words.front().substr(0, words.front().find('=')), {}, gesture};
  for (const sim::Setting& setting : settings) {
    if (!setting.internal) {
      entry.steps.push_back({place_of(setting), parameters_.at(place_of(setting)).wanted, setting.value});
    }
    schedule(tick, setting);
  }
  if (!entry.steps.empty()) {
    history_.add(std::move(entry));
  }
  return tick;
}

bool LiveSimulation::undo() {
  const ChangeHistory::Entry* entry = history_.to_undo();
  if (entry == nullptr) {
    return false;
  }
  std::vector<sim::Setting> settings;
  for (const ChangeHistory::Step& step : entry->steps) {
    settings.push_back(setting_of(step.place, step.before));
  }
  history_.undone();
  schedule_each(settings);
  return true;
}

bool LiveSimulation::redo() {
  const ChangeHistory::Entry* entry = history_.to_redo();
  if (entry == nullptr) {
    return false;
  }
  std::vector<sim::Setting> settings;
  for (const ChangeHistory::Step& step : entry->steps) {
    settings.push_back(setting_of(step.place, step.after));
  }
  history_.redone();
  schedule_each(settings);
  return true;
}

void LiveSimulation::swap_sets() {
  std::vector<sim::Setting> settings;
  const std::vector<ParameterPlace>& places = parameters_.places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::int32_t wanted = parameters_.at(places[i]).wanted;
    const std::int32_t other = std::exchange(other_set_[i], wanted);
    if (other != wanted) {
      settings.push_back(setting_of(places[i], other));
    }
  }
  is_set_b_ = !is_set_b_;
  schedule_each(settings);
}

void LiveSimulation::reset(const std::vector<ParameterPlace>& places) {
  std::vector<sim::Setting> settings;
  ChangeHistory::Entry entry{"reset", {}, std::nullopt};
  for (const ParameterPlace& place : places) {
    const ParameterTable::Values& values = parameters_.at(place);
    if (values.wanted != values.file) {
      settings.push_back(setting_of(place, values.file));
      entry.steps.push_back({place, values.wanted, values.file});
    }
  }
  if (!settings.empty()) {
    history_.add(std::move(entry));
    schedule_each(settings);
  }
}

std::vector<ParameterPlace> LiveSimulation::places_of(const std::string& name) const {
  const sim::SettingTarget target = sim::find_target(file_, name + "=0");
  if (target.internal) {
    throw InputError(shortened(name), 0, "an internal value", "a parameter");
  }
  std::vector<ParameterPlace> places;
  for (const unsigned joint : target.joints) {
    places.push_back({static_cast<std::uint8_t>(target.slot), static_cast<std::uint8_t>(joint),
                      static_cast<std::uint8_t>(target.index)});
  }
  return places;
}

std::vector<sim::ActuationEdit> LiveSimulation::file_edits() const {
  sim::Scenario wanted = without_sources(file_);
  for (const ParameterPlace& place : parameters_.places()) {
    sim::set_start_value(wanted, setting_of(place, parameters_.at(place).wanted));
  }
  return sim::actuation_edits(file_, wanted);
}

void LiveSimulation::apply_to_file(std::span<const sim::ActuationEdit> edits) {
  file_ = write_actuation(file_, edits);
  given_ = with_settings(file_, settings_);
  parameters_.set_file(file_);
  ++revision_;
}

void LiveSimulation::move(const std::string& place) {
  scratch_.moves.clear();
  sim::add_move(scratch_, place + '@' + std::to_string(simulation_->tick()));
  const sim::RobotMove& move = scratch_.moves.front();
  simulation_->apply_moves();  // those of the command line come before
  static_cast<void>(sim::placement(move, simulation_->plant().link_poses(), scenario_));
  scenario_.moves.insert(std::ranges::upper_bound(scenario_.moves, move.tick, {}, &sim::RobotMove::tick), move);
  live_moves_.push_back(move);
  simulation_->apply_moves();
  ++revision_;
}

void LiveSimulation::restart(StartValues values) {
  end_recording();
  if (values == StartValues::file) {
    parameters_.want_file_values();
  }
  for (const ParameterPlace& place : parameters_.places()) {
    sim::set_start_value(scenario_, setting_of(place, parameters_.at(place).wanted));
  }
  scenario_.changes = given_.changes;
  scenario_.moves = given_.moves;
  scenario_.sources = file_.sources;
  live_.clear();
  live_moves_.clear();
  lost_frames_ = 0;
  parameters_.begin_run();
  ++revision_;
  begin();
}

void LiveSimulation::record_tick(sim::Recorder& recorder, sim::Simulation& simulation, const sim::Change* change) {
  if (change != nullptr) {
    recorder.record_change(*change);
  }
  recorder.record_tick(simulation.sample());
}

void LiveSimulation::advance() {
  const std::uint32_t tick = simulation_->tick();
  const sim::Change* change = simulation_->advance();
  if (recorder_ != nullptr) {
    try {
      record_tick(*recorder_, *simulation_, change);
    } catch (const FileError& error) {
      recording_failure_ = error.what();
      recorder_.reset();
    }
  }
  lost_frames_ += simulation_->chain().lost().size();
  if (change == nullptr) {
    return;
  }
  for (const sim::Setting& setting : change->settings) {
    if (setting.internal) {
      continue;
    }
    const ParameterPlace place = place_of(setting);
    parameters_.confirm(place, setting.value, tick);
    if (!was_asked_for(place, tick)) {
      parameters_.want(place, setting.value);  // a change of the file
    }
  }
  ++revision_;
}

std::vector<std::string> LiveSimulation::repeating_words() const {
  std::vector<std::string> words;
  std::vector<LiveSetting> start;
  for (const ParameterPlace& place : parameters_.places()) {
    const std::int32_t value = sim::start_value(scenario_, place.slot, place.joint, place.index);
    if (value != sim::start_value(given_, place.slot, place.joint, place.index)) {
      start.push_back({0, setting_of(place, value)});
    }
  }
  add_words(std::move(start), false, words);
  std::vector<LiveSetting> past = live_;
  std::erase_if(past, [this](const LiveSetting& live) { return live.tick >= simulation_->tick(); });
  add_words(std::move(past), true, words);
  return words;
}

std::vector<std::string> LiveSimulation::repeating_moves() const {
  std::vector<std::string> words;
  for (const sim::RobotMove& move : live_moves_) {
    if (move.tick < simulation_->tick()) {
      words.push_back(sim::move_text(move));
    }
  }
  return words;
}

bool LiveSimulation::record(const std::filesystem::path& path, const std::string& program, const std::string& build_id,
                            const std::function<bool()>& goes_on) {
  end_recording();
  auto recorder = std::make_unique<sim::Recorder>(path, scenario_, program, build_id);
  auto again = std::make_unique<sim::Simulation>(scenario_, losses_);
  while (again->tick() < simulation_->tick()) {
    if (!goes_on()) {
      return false;
    }
    record_tick(*recorder, *again, again->advance());
  }
  again->apply_moves();
  simulation_ = std::move(again);
  recorder_ = std::move(recorder);
  ++revision_;
  return true;
}

void LiveSimulation::end_recording() {
  if (recorder_ == nullptr) {
    return;
  }
  const std::unique_ptr<sim::Recorder> recorder = std::move(recorder_);
  ++revision_;
  if (simulation_->tick() > 0) {
    recorder->finish(results_of(*simulation_, scenario_, lost_frames_));
  }
}

/// The simulation before is destroyed first: the iterative solver has one random generator in the process, which each
/// new world begins anew.
void LiveSimulation::begin() {
  simulation_.reset();
  simulation_ = std::make_unique<sim::Simulation>(scenario_, losses_);
}

bool LiveSimulation::was_asked_for(const ParameterPlace& place, std::uint32_t from_tick) const {
  for (auto live = live_.rbegin(); live != live_.rend() && live->tick >= from_tick; ++live) {
    if (!live->setting.internal && place_of(live->setting) == place) {
      return true;
    }
  }
  return false;
}

bool LiveSimulation::fits(std::uint32_t tick, const std::vector<sim::Setting>& settings) const {
  const auto change = std::ranges::lower_bound(scenario_.changes, tick, {}, &sim::Change::tick);
  if (change == scenario_.changes.end() || change->tick != tick) {
    return true;
  }
  std::vector<sim::Setting> merged = change->settings;
  for (const sim::Setting& setting : settings) {
    sim::put_setting(merged, setting);
  }
  return std::ranges::all_of(merged, [&](const sim::Setting& setting) {
    return std::ranges::count(merged, setting.joint, &sim::Setting::joint) <=
           static_cast<std::ptrdiff_t>(max_staged_values);
  });
}

void LiveSimulation::schedule(std::uint32_t tick, const sim::Setting& setting) {
  auto change = std::ranges::lower_bound(scenario_.changes, tick, {}, &sim::Change::tick);
  if (change == scenario_.changes.end() || change->tick != tick) {
    change = scenario_.changes.insert(change, sim::Change{tick, {}});
  }
  sim::put_setting(change->settings, setting);
  const auto same_tick = std::ranges::lower_bound(live_, tick, {}, &LiveSetting::tick);
  live_.erase(std::remove_if(same_tick, live_.end(),
                             [&](const LiveSetting& live) {
                               return live.setting.internal == setting.internal &&
                                      place_of(live.setting) == place_of(setting);
                             }),
              live_.end());
  live_.push_back({tick, setting});
  if (!setting.internal) {
    parameters_.want(place_of(setting), setting.value);
  }
  ++revision_;
}

void LiveSimulation::schedule_each(const std::vector<sim::Setting>& settings) {
  std::uint32_t tick = std::max(simulation_->tick(), live_.empty() ? 0 : live_.back().tick);
  for (const sim::Setting& setting : settings) {
    while (!fits(tick, {setting})) {
      ++tick;
    }
    schedule(tick, setting);
  }
  ++revision_;
}

void LiveSimulation::add_words(std::vector<LiveSetting> settings, bool with_tick,
                               std::vector<std::string>& words) const {
  while (!settings.empty()) {
    const LiveSetting first = settings.front();
    // The same value for all joints of the module is one word.
    const auto is_same = [&](const LiveSetting& other) {
      return other.tick == first.tick && other.setting.slot == first.setting.slot &&
             other.setting.index == first.setting.index && other.setting.internal == first.setting.internal &&
             other.setting.value == first.setting.value;
    };
    const Slot& slot = scenario_.kernel.slots[first.setting.slot];
    const Declaration& declaration = slot.algorithm->declaration();
    const bool internal = first.setting.internal;
    const std::string_view name = internal ? declaration.internal_values[first.setting.index].name
                                           : declaration.parameters[first.setting.index].name;
    const Unit unit = internal ? declaration.internal_values[first.setting.index].unit
                               : declaration.parameters[first.setting.index].unit;
    const bool is_uniform = std::ranges::count_if(settings, is_same) == static_cast<std::ptrdiff_t>(slot.group.size());
    std::string word = std::to_string(first.setting.slot + 1) + '.' + std::string(name);
    if (is_uniform) {
      std::erase_if(settings, is_same);
    } else {
      word += ':' + scenario_.robot.joints[first.setting.joint].name;
      settings.erase(settings.begin());
    }
    word += '=' + std::string(format_decimal(first.setting.value, unit).view());
    if (with_tick) {
      word += '@' + std::to_string(first.tick);
    }
    words.push_back(std::move(word));
  }
}

}  // namespace proleg::tools
