#include "tools/proleg/robot/live_changes.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/setting_word.hpp"

namespace proleg::tools {
namespace {

std::vector<canopen::ChangedValue> values_of(const std::vector<sim::Setting>& settings) {
  std::vector<canopen::ChangedValue> values;
  values.reserve(settings.size());
  for (const sim::Setting& setting : settings) {
    values.push_back({setting.slot, setting.joint, setting.index, setting.internal, setting.value});
  }
  return values;
}

}  // namespace

LiveChanges::LiveChanges(const sim::Scenario& scenario, std::vector<canopen::Change> planned)
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
  if (std::ranges::find(planned_, tick, &canopen::Change::tick) != planned_.end()) {
    throw InputError(word, 0, "tick " + std::to_string(tick) + ", which has a change already", "another tick");
  }
  const canopen::Change added{tick, values_.emplace_back(values_of(parsed.settings))};
  planned_.insert(std::ranges::upper_bound(planned_, added.tick, {}, &canopen::Change::tick), added);
  return release(now);
}

void LiveChanges::add(const std::vector<sim::Setting>& settings) {
  without_tick_.push_back(changes_.size());
  changes_.push_back({canopen::Change::soon, values_.emplace_back(values_of(settings))});
}

void LiveChanges::remove_last() {
  changes_.pop_back();
  if (!without_tick_.empty() && without_tick_.back() == changes_.size()) {
    without_tick_.pop_back();
  }
}

bool LiveChanges::release(std::uint32_t now) {
  // A change behind one without a tick must be later than the tick that the master chooses for it.
  const bool is_open = !changes_.empty() && changes_.back().tick == canopen::Change::soon;
  if (planned_.empty() || is_open || planned_.front().tick > now + lead_ticks_) {
    return false;
  }
  const canopen::Change next = planned_.front();
  planned_.erase(planned_.begin());
  if (!changes_.empty() && next.tick <= changes_.back().tick) {
    ++too_late_;
    return release(now);
  }
  changes_.push_back(next);
  return true;
}

std::vector<sim::Change> LiveChanges::take_decided(std::uint32_t tick) {
  std::vector<sim::Change> decided;
  for (; taken_ < changes_.size() && changes_[taken_].tick <= tick; ++taken_) {
    const canopen::Change& change = changes_[taken_];
    if (change.dropped) {
      continue;
    }
    sim::Change& taken = decided.emplace_back();
    taken.tick = change.tick;
    for (const canopen::ChangedValue& value : change.values) {
      taken.settings.push_back({value.slot, value.joint, value.number, value.internal, value.value});
    }
  }
  return decided;
}

std::uint64_t LiveChanges::dropped() const {
  return too_late_ + static_cast<std::uint64_t>(std::ranges::count_if(changes_, &canopen::Change::dropped));
}

std::uint64_t LiveChanges::unfinished() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(
      without_tick_, [this](std::size_t position) { return position >= taken_ && !changes_[position].dropped; }));
}

}  // namespace proleg::tools
