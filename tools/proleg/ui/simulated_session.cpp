#include "tools/proleg/ui/simulated_session.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/measure/measure.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/values.hpp"
#include "tools/proleg/common/run_measures.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/document/telemetry_row.hpp"
#include "tools/proleg/ui/actuation_file.hpp"
#include "tools/proleg/ui/newest_algorithms.hpp"
#include "tools/proleg/ui/recording_folder.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr double slowest_factor = 0.1;
constexpr double fastest_factor = 100.0;
constexpr std::uint32_t most_steps = 1'000;
constexpr std::uint32_t default_tick_period_us = 10'000;  // until there is a simulation

/// Text "12.30 s" for a person.
std::string seconds_text(double seconds) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f s", seconds);
  return text.data();
}

json measures_json(const LiveSimulation& live) {
  json values = json::object();
  if (live.simulation().tick() > 0) {
    const sim::MeasureValues measured = live.simulation().measures();
    for (const sim::MeasureDeclaration& measure : sim::measures()) {
      if (const double value = measured[measure.measure]; std::isfinite(value)) {
        values[std::string(measure.name)] = value;
      }
    }
  }
  return values;
}

}  // namespace

SimulatedSession::SimulatedSession(std::unique_ptr<LiveSimulation> live, SimulatedSessionOptions options,
                                   SessionRequests& requests, host::SessionOutput& output)
    : SessionThread(requests, output),
      options_(std::move(options)),
      folder_(options_.recordings),
      live_(std::move(live)),
      pace_(live_ == nullptr ? default_tick_period_us : live_->scenario().kernel.tick_period_us),
      state_(options_.starts_paused ? State::paused : State::running) {
  if (live_ != nullptr) {
    publish_robot();
  }
  pace_.begin(Clock::now());
  begin_thread();
}

void SimulatedSession::publish_robot() {
  const sim::Scenario& scenario = live_->scenario();
  output_.publish("robot", robot_document(scenario, "simulation"));
  publish_session(Clock::now());  // with the number of the run, before its signals
  output_.set_signals(host::SignalLayout(signals_of(scenario)), scenario.kernel.tick_period_us);
  published_revision_ = 0;
  publish_changes();
}

SimulatedSession::~SimulatedSession() { end_thread(); }

void SimulatedSession::serve() {
  // A simulation goes on without a driver.
  static_cast<void>(requests_.take_holder());
  stop_at_once();
  take_operations();
  const Clock::time_point now = Clock::now();
  if (may_tick() && (steps_left_ > 0 || now >= pace_.due())) {
    tick();
  }
  if (live_ != nullptr) {
    publish_changes();
    if (is_session_new_ || (may_tick() && now >= publish_at_)) {
      publish_session(now);
    }
  }
  wait();
}

void SimulatedSession::fail(const std::string& why) {
  failure_ = why;
  stop_steps();
  set_state(State::failed);
}

/// Waits until there is something to do.
void SimulatedSession::wait() {
  const bool has_news = live_ != nullptr && is_session_new_;
  if (has_news || steps_left_ > 0 || (may_tick() && Clock::now() >= pace_.due())) {
    return;
  }
  if (may_tick()) {
    requests_.wait_until(pace_.due());
  } else {
    requests_.wait();
  }
}

void SimulatedSession::stop_at_once() {
  for (const SessionRequests::Stop& stop : take_stops()) {
    stop_steps();
    if (state_ != State::failed) {
      stopped_by_ = stop.by;
      set_state(State::stopped);
    }
    const auto joints = live_ == nullptr ? 0U : static_cast<unsigned>(live_->scenario().robot.joints.size());
    output_.stopped(stop.request, joints, joints,
                    std::chrono::duration<double, std::milli>(Clock::now() - stop.since).count());
    output_.notice(host::NoticeLevel::warning, "stopped by " + stop.by);
  }
}

json SimulatedSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{{"run", &SimulatedSession::go_on},
                                                            {"pause", &SimulatedSession::pause},
                                                            {"step", &SimulatedSession::step},
                                                            {"restart", &SimulatedSession::restart},
                                                            {"factor", &SimulatedSession::set_factor},
                                                            {"set", &SimulatedSession::set},
                                                            {"undo", &SimulatedSession::undo},
                                                            {"redo", &SimulatedSession::redo},
                                                            {"swap", &SimulatedSession::swap},
                                                            {"reset", &SimulatedSession::reset},
                                                            {"move", &SimulatedSession::move},
                                                            {"record", &SimulatedSession::record},
                                                            {"continue", &SimulatedSession::continue_recording},
                                                            {"command_line", &SimulatedSession::tell_command_line},
                                                            {"file.diff", &SimulatedSession::tell_file_diff},
                                                            {"file.apply", &SimulatedSession::apply_to_file},
                                                            {"file.save_as", &SimulatedSession::save_as},
                                                            {"load_draft", &SimulatedSession::load_draft},
                                                            {"ping", &SimulatedSession::ping}};
  const Handler handler = handler_of(handlers, operation.name);
  require_possible(operation.name);
  return (this->*handler)(operation.arguments);
}

void SimulatedSession::require_possible(const std::string& operation) const {
  if (live_ == nullptr && operation != "continue" && operation != "load_draft" && operation != "ping") {
    throw std::runtime_error(
        "there is no simulation; simulate what the page Make has, or continue one from a recording");
  }
  if (is_repeating_ && operation != "pause" && operation != "ping") {
    throw std::runtime_error("the run of " + repeated_->name() + " is computed again; wait, or pause it");
  }
}

void SimulatedSession::require_sound() const {
  if (state_ == State::failed) {
    throw std::runtime_error("the simulation has failed; restart it");
  }
}

void SimulatedSession::require_saved_draft() const {
  if (is_unsaved_draft_) {
    throw std::runtime_error("this simulation is of a draft that is not saved; save it in Make, and simulate it again");
  }
}

void SimulatedSession::require_file() const {
  require_saved_draft();
  if (!options_.has_file) {
    throw std::runtime_error(
        "this robot has no file yet; Save as writes its files, as `proleg new robot --joints 5` does");
  }
  if (repeated_ != nullptr) {
    throw std::runtime_error("this robot is that of the recording " + repeated_->name() + ", which stays as it is");
  }
}

json SimulatedSession::go_on(const json& /*arguments*/) {
  require_sound();
  pace_.begin(Clock::now());
  set_state(State::running);
  return json::object();
}

json SimulatedSession::pause(const json& /*arguments*/) {
  require_sound();
  stop_steps();
  set_state(State::paused);
  return json::object();
}

json SimulatedSession::step(const json& arguments) {
  require_sound();
  const auto ticks = argument<std::uint32_t>(arguments, "ticks", "a number of ticks").value_or(1);
  if (ticks < 1 || ticks > most_steps) {
    throw InputError("ticks", 0, std::to_string(ticks), "1 to " + std::to_string(most_steps));
  }
  set_state(State::paused);
  steps_left_ = ticks;
  return json::object();
}

json SimulatedSession::restart(const json& arguments) {
  const auto values = argument<std::string>(arguments, "parameters", "\"wanted\" or \"file\"").value_or("wanted");
  if (values != "wanted" && values != "file") {
    throw InputError("parameters", 0, in_quotes(shortened(values)), "\"wanted\" or \"file\"");
  }
  end_recording();
  for (const std::string& name :
       live_->restart(values == "file" ? LiveSimulation::StartValues::file : LiveSimulation::StartValues::wanted)) {
    output_.notice(host::NoticeLevel::warning,
                   "the new version of " + name + " has other parameters; Simulate in Make uses it");
  }
  failure_.clear();
  steps_left_ = 0;
  ++run_;
  pace_.begin(Clock::now());
  set_state(state_ == State::running ? State::running : State::paused);
  return json::object();
}

json SimulatedSession::set_factor(const json& arguments) {
  const auto factor = argument<double>(arguments, "value", "a number");
  if (!factor || !(*factor == 0.0 || (*factor >= slowest_factor && *factor <= fastest_factor))) {
    throw InputError("factor", 0, factor ? exact_text(*factor) : "no value", "0.1 to 100, or 0: as fast as it goes");
  }
  pace_.set_factor(*factor, Clock::now());
  is_session_new_ = true;
  return json::object();
}

json SimulatedSession::set(const json& arguments) {
  const auto words = argument<std::vector<std::string>>(arguments, "words", "texts such as \"amplitude:J2=30\"");
  const auto gesture = argument<std::uint64_t>(arguments, "gesture", "a whole number");
  return {{"tick", live_->set(words.value_or(std::vector<std::string>{}), gesture)}};
}

json SimulatedSession::undo(const json& /*arguments*/) {
  if (!live_->undo()) {
    throw std::runtime_error("there is nothing to undo");
  }
  return json::object();
}

json SimulatedSession::redo(const json& /*arguments*/) {
  if (!live_->redo()) {
    throw std::runtime_error("there is nothing to redo");
  }
  return json::object();
}

json SimulatedSession::swap(const json& /*arguments*/) {
  live_->swap_sets();
  return json::object();
}

json SimulatedSession::reset(const json& arguments) {
  live_->reset(live_->places_of(parameter_names(arguments)));
  return json::object();
}

json SimulatedSession::move(const json& arguments) {
  require_sound();
  if (state_ != State::paused || steps_left_ > 0) {
    throw InputError("move", 0, "a simulation that is not paused", "a paused one");
  }
  const auto position = argument<std::vector<double>>(arguments, "position", "three numbers");
  if (!position || position->size() != 3) {
    throw InputError("position", 0, position ? std::to_string(position->size()) + " numbers" : "none", "three numbers");
  }
  const auto require_in = [](const char* name, double number, const sim::Range& range) {
    if (!(number >= range.min && number <= range.max)) {
      throw InputError(
          name, 0, number_text(number),
          "numbers from " + number_text(range.min) + " to " + number_text(range.max) + " " + std::string(range.unit));
    }
  };
  std::string place;
  for (const double coordinate : *position) {
    require_in("position", coordinate, sim::coordinates);
    place += exact_text(coordinate) + ',';
  }
  const double turn = argument<double>(arguments, "turn", "degrees").value_or(0.0);
  require_in("turn", turn, sim::turns);
  live_->move(place + exact_text(turn));
  is_session_new_ = true;
  return {{"tick", live_->simulation().tick()}};
}

json SimulatedSession::record(const json& arguments) {
  const auto file = argument<std::string>(arguments, "file", "a file name");
  is_session_new_ = true;
  if (!file) {
    end_recording();
    return json::object();
  }
  require_sound();
  begin_recording(*file);
  return {{"file", recording_}};
}

json SimulatedSession::continue_recording(const json& arguments) {
  const auto file = argument<std::string>(arguments, "file", "the name of a recording");
  const auto tick = argument<std::uint32_t>(arguments, "tick", "a tick of the recording");
  if (!tick) {
    throw InputError("tick", 0, "none", "a tick of the recording");
  }
  auto repeated = std::make_unique<RepeatedRun>(folder_.find(file.value_or("")), *tick);
  auto live = std::make_unique<LiveSimulation>(repeated->scenario(), std::vector<std::string>{}, &repeated->losses());
  live->repeat(repeated->inputs());
  end_recording();
  live_ = std::move(live);
  repeated_ = std::move(repeated);
  is_unsaved_draft_ = false;
  options_.command = repeated_->command();
  failure_.clear();
  ++run_;
  pace_ = RunPace(live_->scenario().kernel.tick_period_us);
  set_state(State::paused);
  steps_left_ = *tick + 1;
  is_repeating_ = true;
  publish_robot();
  return {{"tick", *tick}};
}

json SimulatedSession::load_draft(const json& /*arguments*/) {
  const PresentDraft::Content draft = options_.draft == nullptr ? PresentDraft::Content{} : options_.draft->get();
  if (draft.scenario == nullptr) {
    throw std::runtime_error("there is no draft");
  }
  auto live = std::make_unique<LiveSimulation>(*draft.scenario, std::vector<std::string>{}, nullptr);
  end_recording();
  live_ = std::move(live);
  repeated_.reset();
  is_repeating_ = false;
  is_unsaved_draft_ = !draft.is_saved;
  options_.has_file = draft.is_saved;
  options_.command =
      draft.is_saved && options_.command_of_copy ? options_.command_of_copy(draft.scenario->path) : std::string();
  failure_.clear();
  steps_left_ = 0;
  ++run_;
  pace_ = RunPace(live_->scenario().kernel.tick_period_us);
  pace_.begin(Clock::now());
  set_state(state_ == State::running ? State::running : State::paused);
  publish_robot();
  return {{"revision", draft.revision}};
}

json SimulatedSession::tell_file_diff(const json& /*arguments*/) {
  require_file();
  return file_diff_json(live_->file(), live_->file_edits());
}

json SimulatedSession::apply_to_file(const json& arguments) {
  require_file();
  const std::vector<sim::ActuationEdit> edits = chosen_edits(live_->file(), live_->file_edits(), arguments);
  live_->apply_to_file(edits);
  output_.notice(host::NoticeLevel::info,
                 "wrote " + std::to_string(edits.size()) + " changes into " + one_line(live_->file().actuation_file));
  return {{"written", edits.size()}};
}

json SimulatedSession::save_as(const json& arguments) {
  if (repeated_ != nullptr || is_unsaved_draft_) {
    require_file();
  }
  const auto name = argument<std::string>(arguments, "folder", "the name of a new folder");
  live_->save_as(new_folder_in(options_.recordings, name.value_or(""), "folder"));
  const std::string& file = live_->file().path;
  options_.has_file = true;
  if (options_.command_of_copy) {
    options_.command = options_.command_of_copy(file);
  }
  publish_robot();
  output_.notice(host::NoticeLevel::info, "saved as " + one_line(file) + "; Apply to file writes there from now on");
  return {{"file", one_line(file)}};
}

json SimulatedSession::ping(const json& /*arguments*/) { return json::object(); }

json SimulatedSession::tell_command_line(const json& /*arguments*/) {
  if (repeated_ != nullptr && repeated_->losses().any()) {
    throw std::runtime_error("the frames that were lost in " + repeated_->name() + " are in no option of a command");
  }
  require_saved_draft();
  if (has_newer_algorithms(live_->scenario())) {
    throw std::runtime_error(
        "an algorithm of this run was built again since the run began: a command would use the new one; Restart first");
  }
  std::string text = options_.command;
  for (const std::string& word : live_->repeating_words()) {
    text += " --set " + word;
  }
  for (const std::string& word : live_->repeating_moves()) {
    text += " --move " + word;
  }
  const sim::Simulation& simulation = live_->simulation();
  return {{"text", text + " --seconds " + exact_text(simulation.time_s())},
          {"setpoint_hash", simulation.setpoint_hash().hex()},
          {"servo_hash", simulation.servo_hash().hex()},
          {"motion_hash", simulation.motion_hash()}};
}

void SimulatedSession::tick() {
  live_->advance();
  const sim::TickSample sample = live_->sample();
  fill_row(sample, live_->scenario(), row_);
  if (const std::optional<std::string> failure = live_->take_recording_failure()) {
    output_.notice(host::NoticeLevel::error, "the recording has ended: " + one_line(*failure));
    recording_.clear();
    is_session_new_ = true;
  }
  if (!sample.moves.empty()) {
    publish_session(Clock::now());  // before the row that it explains
  }
  output_.add_row(run_, live_->simulation().tick() - 1, row_);
  pace_.tick_done(Clock::now());
  if (steps_left_ > 0 && --steps_left_ == 0) {
    is_session_new_ = true;
  }
  if (is_repeating_) {
    check_repetition(sample);
  }
}

void SimulatedSession::check_repetition(const sim::TickSample& sample) {
  try {
    repeated_->check(sample);
  } catch (const std::exception& error) {
    // The file is damaged. The simulation is sound, and stays where it has come to.
    stop_steps();
    is_session_new_ = true;
    output_.notice(host::NoticeLevel::error, one_line(error.what()));
    return;
  }
  if (sample.tick == repeated_->last_tick()) {
    is_repeating_ = false;
    is_session_new_ = true;
    output_.notice(repeated_->has_differences() ? host::NoticeLevel::warning : host::NoticeLevel::info,
                   repeated_->verdict());
  }
}

void SimulatedSession::begin_recording(const std::string& file) {
  const std::filesystem::path path = new_recording(options_.recordings, file);
  if (!live_->record(path, "simulate", options_.build_id, [this] { return !requests_.interrupts(); })) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw std::runtime_error("the recording was given up: STOP");
  }
  pace_.begin(Clock::now());
  recording_ = path.string();
  if (const double past_s = live_->simulation().time_s(); past_s > 0.0) {
    output_.notice(host::NoticeLevel::info,
                   "the recording begins with the " + seconds_text(past_s) + " that the run has had before");
  }
}

void SimulatedSession::end_recording() {
  if (live_ == nullptr || !live_->is_recording()) {
    return;
  }
  const std::string path = std::exchange(recording_, {});
  live_->end_recording();
  output_.notice(host::NoticeLevel::info, "recorded " + seconds_text(live_->simulation().time_s()) + " in " + path);
}

void SimulatedSession::stop_steps() {
  steps_left_ = 0;
  is_repeating_ = false;
}

void SimulatedSession::set_state(State state) {
  state_ = state;
  if (state != State::stopped) {
    stopped_by_.clear();
  }
  is_session_new_ = true;
}

void SimulatedSession::publish_session(Clock::time_point now) {
  constexpr const char* names[] = {"paused", "running", "stopped", "failed"};
  const sim::Simulation& simulation = live_->simulation();
  const double measured = pace_.measure(now);
  const std::optional<std::uint32_t> last_move = live_->last_move();
  const std::optional<double> recent_speed = simulation.plant().meter().recent_speed();
  json repeats;
  if (is_repeating_) {
    repeats = {{"file", repeated_->name()}, {"tick", repeated_->last_tick()}};
  }
  const json document{{"state", names[static_cast<std::size_t>(state_)]},
                      {"factor", pace_.factor()},
                      {"measured_factor", state_ == State::running ? json(measured) : json()},
                      {"run", run_},
                      {"tick", simulation.tick()},
                      {"time_s", simulation.time_s()},
                      {"stopped_by", text_or_null(stopped_by_)},
                      {"head", pose_json(simulation.plant().link_poses().front())},
                      {"moved", simulation.was_moved()},
                      {"last_move", last_move ? json(*last_move) : json()},
                      {"repeats", repeats},
                      {"recording", text_or_null(recording_)},
                      {"changed", live_->differs_from_file()},
                      {"undo", text_or_null(live_->history().name_to_undo())},
                      {"redo", text_or_null(live_->history().name_to_redo())},
                      {"set", std::string(1, live_->set_name())},
                      {"failure", text_or_null(failure_)},
                      {"recent_speed", recent_speed ? json(*recent_speed) : json()},
                      {"servo_problem", text_or_null(servo_problem(live_->recent_servos(), live_->scenario().robot))},
                      {"measures", measures_json(*live_)}};
  output_.publish("session", document);
  is_session_new_ = false;
  publish_at_ = now + publish_period;
}

void SimulatedSession::publish_changes() {
  if (live_->revision() != published_revision_) {
    published_revision_ = live_->revision();
    output_.publish("parameters", parameters_document(live_->scenario(), live_->parameters()));
    is_session_new_ = true;
  }
}

}  // namespace proleg::tools
