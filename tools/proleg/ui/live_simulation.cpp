#include "tools/proleg/ui/live_simulation.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/robot_move.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/run/simulation_texts.hpp"
#include "tools/proleg/ui/actuation_file.hpp"
#include "tools/proleg/ui/newest_algorithms.hpp"

namespace proleg::tools {
namespace {

sim::Scenario with_settings(sim::Scenario scenario, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    sim::apply_setting(scenario, word);
  }
  return scenario;
}

}  // namespace

LiveSimulation::LiveSimulation(sim::Scenario file, std::vector<std::string> settings, const sim::Losses* losses)
    : file_(std::move(file)),
      settings_(std::move(settings)),
      given_(with_settings(file_, settings_)),
      losses_(losses),
      scenario_(given_),
      edits_(file_, given_) {
  for (const ParameterPlace& place : parameters().places()) {
    other_set_.push_back(parameters().at(place).file);
  }
  begin();
}

std::uint32_t LiveSimulation::set(const std::vector<std::string>& words, std::optional<std::uint64_t> gesture) {
  const std::vector<Setting> settings = edits_.set(words, gesture);
  std::uint32_t tick = std::max(simulation_->tick(), live_.empty() ? 0 : live_.back().tick);
  while (!fits(tick, settings)) {
    ++tick;
  }
  for (const Setting& setting : settings) {
    schedule(tick, setting);
  }
  return tick;
}

bool LiveSimulation::undo() {
  const std::optional<std::vector<Setting>> settings = edits_.undo();
  if (settings) {
    schedule_each(*settings);
  }
  return settings.has_value();
}

bool LiveSimulation::redo() {
  const std::optional<std::vector<Setting>> settings = edits_.redo();
  if (settings) {
    schedule_each(*settings);
  }
  return settings.has_value();
}

void LiveSimulation::swap_sets() {
  std::vector<Setting> settings;
  const std::vector<ParameterPlace>& places = parameters().places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::int32_t wanted = parameters().at(places[i]).wanted;
    const std::int32_t other = std::exchange(other_set_[i], wanted);
    if (other != wanted) {
      settings.push_back(setting_of(places[i], other));
    }
  }
  is_set_b_ = !is_set_b_;
  schedule_each(settings);
}

void LiveSimulation::reset(const std::vector<ParameterPlace>& places) {
  const std::vector<Setting> settings = edits_.reset(places);
  if (!settings.empty()) {
    schedule_each(settings);
  }
}

std::vector<sim::ActuationEdit> LiveSimulation::file_edits() const {
  return sim::actuation_edits(file_, edits_.scenario_as_wanted());
}

void LiveSimulation::apply_to_file(std::span<const sim::ActuationEdit> edits) {
  use_file(write_actuation(file_, edits));
}

void LiveSimulation::save_as(const std::filesystem::path& folder) { use_file(write_copy(file_, file_edits(), folder)); }

void LiveSimulation::use_file(sim::Scenario file) {
  file_ = std::move(file);
  given_ = with_settings(file_, settings_);
  edits_.parameters().set_file(file_);
  ++revision_;
}

void LiveSimulation::move(const std::string& place) {
  const sim::RobotMove move =
      sim::parse_move(place + '@' + std::to_string(simulation_->tick()), scenario_.kernel.tick_period_us);
  simulation_->apply_moves();  // those of the command line come before
  static_cast<void>(sim::placement(move, simulation_->plant().link_poses(), scenario_));
  scenario_.moves.insert(std::ranges::upper_bound(scenario_.moves, move.tick, {}, &sim::RobotMove::tick), move);
  live_moves_.push_back(move);
  simulation_->apply_moves();
  ++revision_;
}

std::optional<std::uint32_t> LiveSimulation::last_move() const {
  const std::uint32_t tick = simulation_->tick();
  std::optional<std::uint32_t> last;
  for (const sim::RobotMove& move : scenario_.moves) {
    if (move.tick < tick || (move.tick == tick && simulation_->was_moved())) {
      last = move.tick;
    }
  }
  return last;
}

std::vector<std::string> LiveSimulation::restart(StartValues values) {
  end_recording();
  for (sim::Scenario* const scenario : {&file_, &given_}) {
    static_cast<void>(take_newest_algorithms(*scenario));
  }
  std::vector<std::string> others = take_newest_algorithms(scenario_);
  if (values == StartValues::file) {
    edits_.parameters().want_file_values();
  }
  clear_run();
  begin();
  return others;
}

void LiveSimulation::repeat(const RunInputs& inputs) {
  end_recording();
  for (const Setting& setting : inputs.start) {
    edits_.parameters().want(place_of(setting), setting.value);
  }
  clear_run();
  for (const Change& change : inputs.changes) {
    for (const Setting& setting : change.settings) {
      schedule(change.tick, setting);
    }
  }
  scenario_.moves.insert(scenario_.moves.end(), inputs.moves.begin(), inputs.moves.end());
  live_moves_ = inputs.moves;
  begin();
}

void LiveSimulation::clear_run() {
  for (const ParameterPlace& place : parameters().places()) {
    sim::set_start_value(scenario_, setting_of(place, parameters().at(place).wanted));
  }
  scenario_.changes = given_.changes;
  scenario_.moves = given_.moves;
  scenario_.sources = file_.sources;
  live_.clear();
  live_moves_.clear();
  lost_frames_ = 0;
  edits_.parameters().begin_run();
  ++revision_;
}

void LiveSimulation::record_tick(sim::Recorder& recorder, sim::Simulation& simulation, const Change* change) {
  if (change != nullptr) {
    recorder.record_change(*change);
  }
  recorder.record_tick(simulation.sample());
}

void LiveSimulation::advance() {
  const std::uint32_t tick = simulation_->tick();
  const Change* change = simulation_->advance();
  if (recorder_ != nullptr) {
    try {
      record_tick(*recorder_, *simulation_, change);
    } catch (const FileError& error) {
      recording_failure_ = error.what();
      recorder_.reset();
    }
  }
  lost_frames_ += simulation_->chain().lost().size();
  keep_servos();
  if (change == nullptr) {
    return;
  }
  for (const Setting& setting : change->settings) {
    if (setting.internal) {
      continue;
    }
    const ParameterPlace place = place_of(setting);
    edits_.parameters().confirm(place, setting.value, tick);
    if (!was_asked_for(place, tick)) {
      edits_.parameters().want(place, setting.value);  // a change of the file
    }
  }
  ++revision_;
}

void LiveSimulation::keep_servos() {
  constexpr std::uint32_t interval_us = 500'000;
  constexpr std::size_t kept = 8;  // of four seconds
  const std::uint32_t interval = std::max(interval_us / scenario_.kernel.tick_period_us, 1U);
  if (simulation_->tick() % interval != 0) {
    return;
  }
  const std::span<const sim::ServoTracking> servos = simulation_->plant().meter().tracking();
  earlier_servos_.emplace_back(servos.begin(), servos.end());
  if (earlier_servos_.size() > kept) {
    earlier_servos_.pop_front();
  }
}

std::vector<sim::ServoTracking> LiveSimulation::recent_servos() const {
  const std::span<const sim::ServoTracking> servos = simulation_->plant().meter().tracking();
  std::vector<sim::ServoTracking> recent(servos.begin(), servos.end());
  if (!earlier_servos_.empty()) {
    std::ranges::transform(recent, earlier_servos_.front(), recent.begin(),
                           [](const auto& now, const auto& earlier) { return now.since(earlier); });
  }
  return recent;
}

std::vector<std::string> LiveSimulation::repeating_words() const {
  std::vector<std::string> words;
  std::vector<LiveSetting> start;
  for (const ParameterPlace& place : parameters().places()) {
    const std::int32_t value = sim::start_value(scenario_, place.slot, place.joint, place.number);
    if (value != sim::start_value(given_, place.slot, place.joint, place.number)) {
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
  auto recorder = std::make_unique<sim::Recorder>(path, scenario_, program, build_id, sim::EarlierFile::is_refused);
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

void LiveSimulation::begin() {
  earlier_servos_.clear();
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

bool LiveSimulation::fits(std::uint32_t tick, const std::vector<Setting>& settings) const {
  const auto change = std::ranges::lower_bound(scenario_.changes, tick, {}, &Change::tick);
  if (change == scenario_.changes.end() || change->tick != tick) {
    return true;
  }
  std::vector<Setting> merged = change->settings;
  for (const Setting& setting : settings) {
    sim::put_setting(merged, setting);
  }
  return std::ranges::all_of(merged, [&](const Setting& setting) {
    return std::ranges::count(merged, setting.joint, &Setting::joint) <= static_cast<std::ptrdiff_t>(max_staged_values);
  });
}

void LiveSimulation::schedule(std::uint32_t tick, const Setting& setting) {
  auto change = std::ranges::lower_bound(scenario_.changes, tick, {}, &Change::tick);
  if (change == scenario_.changes.end() || change->tick != tick) {
    change = scenario_.changes.insert(change, Change{tick, {}});
  }
  sim::put_setting(change->settings, setting);
  const auto same_tick = std::ranges::lower_bound(live_, tick, {}, &LiveSetting::tick);
  live_.erase(std::remove_if(same_tick, live_.end(),
                             [&](const LiveSetting& live) { return live.setting.has_same_place(setting); }),
              live_.end());
  live_.push_back({tick, setting});
  if (!setting.internal) {
    edits_.parameters().want(place_of(setting), setting.value);
  }
  ++revision_;
}

void LiveSimulation::schedule_each(const std::vector<Setting>& settings) {
  std::uint32_t tick = std::max(simulation_->tick(), live_.empty() ? 0 : live_.back().tick);
  for (const Setting& setting : settings) {
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
    // One word sets the same value for all joints of the module.
    const auto is_same = [&](const LiveSetting& other) {
      return other.tick == first.tick && other.setting.slot == first.setting.slot &&
             other.setting.number == first.setting.number && other.setting.internal == first.setting.internal &&
             other.setting.value == first.setting.value;
    };
    const Slot& slot = scenario_.kernel.slots[first.setting.slot];
    const Declaration& declaration = slot.algorithm->declaration();
    const bool internal = first.setting.internal;
    const std::string_view name = internal ? declaration.internal_values[first.setting.number].name
                                           : declaration.parameters[first.setting.number].name;
    const Unit unit = internal ? declaration.internal_values[first.setting.number].unit
                               : declaration.parameters[first.setting.number].unit;
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
