#include "tools/proleg/ui/repeated_run.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/record/recorded_scenario.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/document/recording_document.hpp"
#include "tools/proleg/run/simulation_texts.hpp"

namespace proleg::tools {
namespace {

constexpr std::uint32_t piece_ticks = 256;  // that are read from the file at once
constexpr std::size_t max_losses = 10'000'000;

}  // namespace

RepeatedRun::RepeatedRun(const std::filesystem::path& path, std::uint32_t last_tick)
    : recording_(std::make_unique<sim::Recording>(path)),
      last_tick_(last_tick),
      overrides_(sim::recorded_overrides(*recording_)),
      scenario_(scenario_of(*recording_, sim::read_overrides(overrides_))) {
  require_simulation();
  read_inputs();
  read_losses();
}

void RepeatedRun::refuse(const std::string& found, const std::string& expected) const {
  throw InputError(name(), 0, found, expected);
}

void RepeatedRun::require_simulation() const {
  constexpr const char* expected = "a recording of a simulation: only that can be computed again";
  if (const std::string program = recording_->run_value("program"); program != "simulate") {
    refuse("a recording of " + in_quotes(program) + ", whose robot had modules", expected);
  }
  if (!recording_->faults().empty() || !recording_->restarts().empty()) {
    refuse("modules that failed or restarted", expected);
  }
  if (recording_->first_tick() != 0) {
    refuse("tick " + std::to_string(recording_->first_tick()) + " as the first one", "a recording from tick 0 on");
  }
  if (last_tick_ > recording_->last_tick()) {
    refuse("tick " + std::to_string(last_tick_), "0 to " + std::to_string(recording_->last_tick()));
  }
}

Setting RepeatedRun::resolve(const sim::RecordedSetting& recorded, bool internal) const {
  const Slot& slot = scenario_.kernel.slots[recorded.slot];
  const Declaration& declaration = slot.algorithm->declaration();
  const int index =
      internal ? find_internal_value(declaration, recorded.name) : find_parameter(declaration, recorded.name);
  if (index < 0 || !slot.group.contains(recorded.joint)) {
    refuse("a value for " + in_quotes(recorded.name) + " in slot " + std::to_string(recorded.slot + 1),
           "names that the algorithms of this program have");
  }
  return {static_cast<std::uint8_t>(recorded.slot), static_cast<std::uint8_t>(recorded.joint),
          static_cast<std::uint8_t>(index), internal, recorded.raw};
}

void RepeatedRun::read_inputs() {
  for (const sim::RecordedSetting& recorded : recording_->parameters()) {
    if (recorded.commit) {
      add_change(recorded, false);
    } else {
      inputs_.start.push_back(resolve(recorded, false));
    }
  }
  for (const sim::RecordedSetting& recorded : recording_->distortions()) {
    add_change(recorded, true);
  }
  inputs_.moves = recording_->moves();
  left_out_ += std::erase_if(inputs_.moves, [this](const sim::RobotMove& move) { return move.tick > last_tick_; });
}

void RepeatedRun::add_change(const sim::RecordedSetting& recorded, bool internal) {
  const Setting setting = resolve(recorded, internal);
  if (recorded.tick > last_tick_) {
    ++left_out_;
    return;
  }
  auto change = std::ranges::lower_bound(inputs_.changes, recorded.tick, {}, &Change::tick);
  if (change == inputs_.changes.end() || change->tick != recorded.tick) {
    change = inputs_.changes.insert(change, {recorded.tick, {}});
  }
  change->settings.push_back(setting);
}

void RepeatedRun::read_losses() {
  std::vector<sim::Loss> list;
  sim::LossReader reader(*recording_);
  while (const std::optional<sim::Loss> loss = reader.next()) {
    if (list.size() == max_losses) {
      refuse("more than " + std::to_string(max_losses) + " lost frames", "fewer");
    }
    list.push_back(*loss);
  }
  if (!list.empty()) {
    losses_ = sim::Losses(std::move(list));
  }
}

std::string RepeatedRun::command() const { return simulate_command(scenario_.path, overrides_, {}, {}); }

void RepeatedRun::check(const sim::TickSample& sample) {
  if (first_difference_ || sample.tick > last_tick_) {
    return;
  }
  if (sample.tick >= expected_from_ + expected_.size()) {
    expected_from_ = sample.tick;
    expected_.clear();
    recording_->read_ticks(sample.tick, std::min(last_tick_, sample.tick + piece_ticks - 1),
                           [this](const sim::RecordedTick& tick) {
                             expected_.push_back({tick.setpoints, tick.link_poses, tick.object_poses});
                           });
  }
  const Expected& expected = expected_[sample.tick - expected_from_];
  const std::optional<sim::MotionDifference> moved =
      sim::compare_motion(sample.tick, sample.link_poses, expected.links, sample.object_poses, expected.objects);
  if (moved || !std::ranges::equal(sample.setpoints, expected.setpoints)) {
    first_difference_ = sample.tick;
    moved_ = moved;
  }
}

std::string RepeatedRun::verdict() const {
  const std::string later =
      left_out_ == 0 ? "" : "; " + std::to_string(left_out_) + " later changes of the recording are left out";
  if (!first_difference_) {
    return name() + ": computed again up to tick " + std::to_string(last_tick_) +
           ", with the same set-points and the same motion of all links, bit for bit" + later;
  }
  std::string other = moved_ ? "; " + sim::name_of(*moved_, *recording_) + " is elsewhere" : "; the set-points differ";
  for (const std::string& sentence : sim::other_program(*recording_, build_id)) {
    other += "; " + one_line(sentence);
  }
  for (const std::string& sentence : sim::other_algorithms(*recording_)) {
    other += "; " + one_line(sentence);
  }
  return name() + ": found other values than the recorded ones from tick " + std::to_string(*first_difference_) +
         " on, expected the same" + other + later;
}

}  // namespace proleg::tools
