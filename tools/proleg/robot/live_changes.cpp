#include "tools/proleg/robot/live_changes.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/master/change_plan.hpp"
#include "sim/scenario/settings.hpp"

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

}  // namespace proleg::tools
