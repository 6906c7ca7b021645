#include "tools/proleg/live_changes.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::tools {

LiveChanges::LiveChanges(const sim::Scenario& scenario, std::vector<canopen::Change> planned)
    : scenario_(scenario), changes_(std::move(planned)) {}

void LiveChanges::add(const std::string& word, std::uint32_t now) {
  const bool has_tick = word.find('@') != std::string::npos;
  sim::Scenario scratch = scenario_;
  scratch.changes.clear();
  // Any tick: the master decides later.
  sim::apply_setting(scratch, has_tick ? word : word + "@1");
  if (scratch.changes.empty()) {
    throw InputError(word, 0, "no change", "NAME=VALUE or NAME=VALUE@TICK");
  }
  const sim::Change& change = scratch.changes.front();
  if (has_tick && change.tick <= now) {
    throw InputError(word, 0, "tick " + std::to_string(change.tick), "a later one than " + std::to_string(now));
  }
  std::vector<canopen::ChangedValue>& values = values_.emplace_back();
  for (const sim::Setting& setting : change.settings) {
    values.push_back({setting.slot, setting.joint, setting.index, setting.internal, setting.value});
  }
  changes_.push_back({has_tick ? change.tick : canopen::Change::soon, values});
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
  return static_cast<std::uint64_t>(std::ranges::count_if(changes_, &canopen::Change::dropped));
}

}  // namespace proleg::tools
