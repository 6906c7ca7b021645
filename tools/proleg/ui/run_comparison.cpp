#include "tools/proleg/ui/run_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

// Ticks that are compared before the session looks for requests again: some milliseconds.
constexpr std::uint32_t ticks_at_once = 128;

}  // namespace

RunComparison::RunComparison(RecordedRun& run, RecordedRun& other) : runs_{&run, &other} {
  const auto require_same = [&](std::uint64_t found, std::uint64_t expected, const std::string& unit) {
    if (found != expected) {
      throw InputError(other.path().filename().string(), 0, std::to_string(found) + ' ' + unit,
                       std::to_string(expected) + ", as in " + run.path().filename().string());
    }
  };
  require_same(other.joint_names().size(), run.joint_names().size(), "joints");
  require_same(other.tick_period_us(), run.tick_period_us(), "microseconds in a tick");
  if (first_tick() > last_tick()) {
    throw InputError(other.path().filename().string(), 0,
                     "ticks " + std::to_string(other.first_tick()) + " to " + std::to_string(other.last_tick()),
                     "some of the ticks " + std::to_string(run.first_tick()) + " to " +
                         std::to_string(run.last_tick()) + " of " + run.path().filename().string());
  }
}

std::uint32_t RunComparison::first_tick() const { return std::max(runs_[0]->first_tick(), runs_[1]->first_tick()); }

std::uint32_t RunComparison::last_tick() const { return std::min(runs_[0]->last_tick(), runs_[1]->last_tick()); }

bool RunComparison::compare_some() {
  const std::uint32_t common = last_tick() - first_tick() + 1;
  if (damage_ || difference_ || compared_ >= common) {
    return false;
  }
  const std::uint32_t from = first_tick() + compared_;
  const std::uint32_t to = from + std::min(ticks_at_once, common - compared_) - 1;
  setpoints_.clear();
  runs_[0]->read_ticks(from, to, [this](const sim::RecordedTick& tick) {
    setpoints_.insert(setpoints_.end(), tick.setpoints.begin(), tick.setpoints.end());
  });
  auto expected = setpoints_.begin();
  runs_[1]->read_ticks(from, to, [&](const sim::RecordedTick& tick) {
    const auto [found, differs] = std::mismatch(tick.setpoints.begin(), tick.setpoints.end(), expected);
    if (found != tick.setpoints.end() && !difference_) {
      const auto joint = static_cast<std::size_t>(found - tick.setpoints.begin());
      difference_ = {tick.tick, runs_[0]->joint_names()[joint]};
    }
    expected += static_cast<std::ptrdiff_t>(tick.setpoints.size());
  });
  compared_ += to - from + 1;
  return !difference_ && compared_ < common;
}

json RunComparison::document() {
  json head = json::array();
  for (RecordedRun* run : runs_) {
    const std::optional<double> way = run->head_way(first_tick(), last_tick());
    head.push_back(way ? json(*way) : json());
  }
  json difference;
  if (difference_) {
    difference = {{"tick", difference_->tick}, {"joint", difference_->joint}};
  }
  return {{"first_tick", first_tick()},
          {"last_tick", last_tick()},
          {"compared", compared_},
          {"difference", std::move(difference)},
          {"damage", damage_ ? json(*damage_) : json()},
          {"head_m", std::move(head)}};
}

}  // namespace proleg::tools
