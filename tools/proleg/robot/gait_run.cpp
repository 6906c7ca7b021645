#include "tools/proleg/robot/gait_run.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "host/robot/host_presence.hpp"
#include "host/robot/sdo_queue.hpp"
#include "host/robot/state_text.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/master/change_plan.hpp"
#include "shared/computer/master/master_report.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

LiveChanges::LiveChanges(const sim::Scenario& scenario, std::vector<Change> planned)
    : scenario_(scenario), lead_ticks_(lead_us / scenario.kernel.tick_period_us), planned_(std::move(planned)) {
  if (const auto bad = canopen::ChangePlan(scenario.kernel, planned_).find_bad()) {
    throw InputError(scenario.path, 0,
                     "a change for tick " + std::to_string(planned_[*bad].tick) + " that no module can make",
                     "at most " + std::to_string(max_staged_values) + " values of a joint");
  }
  while (release(0)) {
  }
}

bool LiveChanges::add(const std::string& word, std::uint32_t now, std::uint32_t end) {
  const sim::ParsedSetting parsed = sim::parse_setting(scenario_, word);
  if (!parsed.tick) {
    add(parsed.settings);
    return true;
  }
  const std::uint32_t tick = *parsed.tick;
  if (tick <= now) {
    throw InputError(word, 0, "tick " + std::to_string(tick), "a later one than " + std::to_string(now));
  }
  if (tick >= end) {
    throw InputError(word, 0, "tick " + std::to_string(tick),
                     "a tick of this run, which ends at tick " + std::to_string(end));
  }
  if (std::ranges::find(planned_, tick, &Change::tick) != planned_.end()) {
    throw InputError(word, 0, "tick " + std::to_string(tick) + ", which has a change already", "another tick");
  }
  planned_.insert(std::ranges::upper_bound(planned_, tick, {}, &Change::tick), {tick, parsed.settings});
  return release(now);
}

void LiveChanges::add(const std::vector<Setting>& settings) {
  without_tick_.push_back(changes_.size());
  changes_.push_back({Change::soon, settings});
}

void LiveChanges::remove_last() {
  changes_.pop_back();
  if (!without_tick_.empty() && without_tick_.back() == changes_.size()) {
    without_tick_.pop_back();
  }
}

bool LiveChanges::release(std::uint32_t now) {
  // A change behind one without a tick must be later than the tick that the master chooses for it.
  const bool is_open = !changes_.empty() && changes_.back().tick == Change::soon;
  if (planned_.empty() || is_open || planned_.front().tick > now + lead_ticks_) {
    return false;
  }
  Change next = std::move(planned_.front());
  planned_.erase(planned_.begin());
  if (!changes_.empty() && next.tick <= changes_.back().tick) {
    ++too_late_;
    return release(now);
  }
  changes_.push_back(std::move(next));
  return true;
}

std::vector<Change> LiveChanges::take_decided(std::uint32_t tick) {
  std::vector<Change> decided;
  for (; taken_ < changes_.size() && changes_[taken_].tick <= tick; ++taken_) {
    if (!changes_[taken_].dropped) {
      decided.push_back(changes_[taken_]);
    }
  }
  return decided;
}

std::uint64_t LiveChanges::dropped() const {
  return too_late_ + static_cast<std::uint64_t>(std::ranges::count_if(changes_, &Change::dropped));
}

std::uint64_t LiveChanges::unfinished() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(
      without_tick_, [this](std::size_t position) { return position >= taken_ && !changes_[position].dropped; }));
}

std::optional<std::string> fit_servo_period(sim::Scenario& scenario, const std::string& bus_address) {
  std::uint32_t& period_us = scenario.robot.servo.period_us;
  if (period_us >= min_real_servo_period_us || !can_have_real_servos(bus_address)) {
    return std::nullopt;
  }
  const auto in_ms = [](std::uint32_t us) { return number_text(us * 1e-3) + " ms"; };
  const std::string found = in_ms(std::exchange(period_us, min_real_servo_period_us));
  return scenario.path + ": found a servo period of " + found + ", used " + in_ms(period_us) +
         ": a real servo needs 2.5 ms for a pulse and a pause of 0.5 ms; the set-points stay the same";
}

using canopen::MasterState;

GaitRun::GaitRun(const sim::Scenario& scenario, host::BusConnection& bus, const GaitRunOptions& options)
    : scenario_(scenario),
      bus_(bus),
      input_(scenario),
      changes_(scenario, std::move(input_.changes)),
      drive_(bus_, input_.setup, master_options(options.holds), changes_.span()),
      watch_(bus_, {input_.setup.nodes.begin(), input_.setup.nodes.end()}),
      answer_times_attachment_(bus_, answer_times_),
      change_times_attachment_(bus_, change_times_),
      drive_attachment_(bus_, drive_),
      watch_attachment_(bus_, watch_),
      check_(scenario),
      end_tick_(options.end_tick) {}

canopen::MasterOptions GaitRun::master_options(bool holds) const {
  canopen::MasterOptions options;
  options.core_fingerprint = core_fingerprint;
  options.serials = input_.serials;
  options.resets_modules = true;
  options.ramps_down = true;
  options.reads_checksums = true;
  options.ramp_in_speed = ramp_in_speed;
  options.holds = holds;
  options.session_token = host::random_token();
  options.answer_timeout_us = host::patient_timeout_us;
  options.attempts = host::patient_attempts;
  return options;
}

bool GaitRun::has_ended() const {
  return state() == MasterState::failed || !bus_.state().is_connected || watch_.loss();
}

std::string GaitRun::why_ended() const {
  using canopen::ProblemCode;
  const canopen::Problem& problem = drive_.master().problem();
  if (!bus_.state().is_connected) {
    return bus_.diagnosis();
  }
  if (const auto& loss = watch_.loss(); loss && state() != MasterState::failed) {
    return text_of(*loss);
  }
  if (problem.code == ProblemCode::none) {
    return "the set-up has not ended in time; " + bus_.diagnosis();
  }
  std::string text = problem_text(problem, [this](std::uint8_t node) { return name_of(node); });
  if (problem.code == ProblemCode::missing_module || problem.code == ProblemCode::cannot_send ||
      problem.code == ProblemCode::no_answer) {
    text += "; " + bus_.diagnosis();
  }
  if (problem.code == ProblemCode::unexpected_node || problem.code == ProblemCode::wrong_serial) {
    text += "; 'proleg assign " + scenario_.path +
            "' gives the modules of this robot their node ids; unplug a module of another robot";
  } else if (problem.code == ProblemCode::duplicate_node) {
    text += "; 'proleg recover' gives one of two modules with one node id another one";
  }
  return text;
}

bool GaitRun::has_bad_setup() const {
  using canopen::ProblemCode;
  const ProblemCode code = drive_.master().problem().code;
  return state() == MasterState::failed && (code == ProblemCode::bad_setup || code == ProblemCode::bus_too_small);
}

std::string GaitRun::text_of(const host::GaitWatch::Loss& loss) const {
  using Reason = host::GaitWatch::Reason;
  const std::string what = loss.reason == Reason::drive ? std::string(host::drive_text(loss.statusword))
                           : loss.reason == Reason::mode
                               ? "its mode is " + std::to_string(loss.mode) + ", expected -1 (gait)"
                               : "its module is " + std::string(host::state_text(loss.state));
  const std::string text = name_of(loss.node) + " does not follow the gait any more: " + what;
  return text + (loss.emergency == canopen::EmergencyCode::none
                     ? "; another program may have done that"
                     : "; the module has reported: " + std::string(canopen::describe(loss.emergency)));
}

void GaitRun::report_events(bool is_verbose, const std::function<void(const std::string& line)>& report) {
  while (const auto event = drive_.master().take_event()) {
    const bool is_news = event->kind != canopen::EventKind::emergency || event->code != canopen::EmergencyCode::none;
    if (is_news || is_verbose) {
      report(event_text(*event, [this](std::uint8_t node) { return name_of(node); }));
    }
    are_all_off_ = are_all_off_ && event->kind != canopen::EventKind::not_stopped;
    if (event->kind == canopen::EventKind::rejoined || event->kind == canopen::EventKind::rejoin_failed) {
      watch_.return_to_gait(event->node);
    }
    if (event->kind == canopen::EventKind::rejoined) {
      rejoined_.push_back(event->node);
    }
    if (event->kind == canopen::EventKind::restarted) {
      check_.end_comparison(name_of(event->node) + " has restarted");
    }
  }
}

void GaitRun::take_ticks(bool at_end, const Observer& observer) {
  if (!is_following_) {
    return;
  }
  is_following_ = false;  // an observer that fails does not work for the rest either
  while (auto tick = drive_.take_tick(at_end)) {
    for (const Change& change : changes_.take_decided(tick->tick)) {
      check_.add_change(change);
      observer.changed(change);
    }
    if (check_.ticks() >= end_tick_) {
      check_.follow_stopping(*tick);
      continue;
    }
    const Change* change = check_.follow(*tick);
    observer.tick(change);
  }
  while (const auto measured = drive_.take_measurement()) {
    observer.measured(*measured);
  }
  is_following_ = true;
}

void GaitRun::add_change(const std::string& word) {
  if (changes_.add(word, drive_.master().tick().value_or(0), end_tick_)) {
    give_new_change(word);
  }
}

void GaitRun::add_change(const std::vector<Setting>& settings) {
  changes_.add(settings);
  give_new_change("a change");
}

void GaitRun::give_new_change(const std::string& what) {
  const std::span<Change> changes = changes_.span();
  if (changes.back().tick == Change::soon) {
    change_times_.accepted(changes.size() - 1, bus_.now(), drive_.master().tick().value_or(0));
  }
  give_changes(what);
}

/// Gives the master the changes that are behind those that it has. what: the last one. Throws InputError.
void GaitRun::give_changes(const std::string& what) {
  if (!drive_.master().extend_changes(bus_.now(), changes_.span())) {
    changes_.remove_last();
    static_cast<void>(drive_.master().extend_changes(bus_.now(), changes_.span()));
    throw InputError(what, 0, "a change that is not later than the one before it, or has too many values",
                     "a later tick");
  }
}

void GaitRun::release_changes() {
  while (changes_.release(drive_.master().tick().value_or(0))) {
    give_changes("the change for tick " + std::to_string(changes_.span().back().tick));
  }
}

void GaitRun::stop() {
  are_all_off_ = true;
  watch_.stop();
  // What the modules send while they stop is not part of the gait.
  end_tick_ = std::min(end_tick_, drive_.master().tick().value_or(0));
  drive_.master().stop(bus_.now());
  // The master gives up by itself: it needs 0.6 s for eight silent modules, or for each of them if others still tick.
  constexpr Microseconds at_most = 20'000'000;
  stops_by_ = bus_.now() + at_most;
}

bool GaitRun::has_stopped() {
  if (!bus_.state().is_connected) {
    // The modules have stopped by themselves by then. Before, the adapter may come back.
    constexpr Microseconds without_connection = 2'000'000;
    stops_by_ = std::min(stops_by_, bus_.now() + without_connection);
  }
  return state() == MasterState::stopped || bus_.now() >= stops_by_;
}

void GaitRun::compare_setpoints() {
  for (unsigned joint = 0; is_following_ && joint < scenario_.modules.size(); ++joint) {
    check_.compare_setpoints(joint, drive_.master().checksum(joint));
  }
}

}  // namespace proleg::tools
