#include "tools/proleg/ui/recorded_session.hpp"

#include <algorithm>
#include <exception>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

// Ticks that are compared before the session looks for requests again: some milliseconds.
constexpr std::uint32_t ticks_at_once = 128;

}  // namespace

RunComparison::RunComparison(RecordedRun& run, RecordedRun& other)
    : runs_{&run, &other}, has_motion_(run.has_world() && other.has_world()) {
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
  if (damage_ || is_decided() || compared_ >= common) {
    return false;
  }
  const std::uint32_t from = first_tick() + compared_;
  const std::uint32_t to = from + std::min(ticks_at_once, common - compared_) - 1;
  ticks_.clear();
  runs_[0]->read_ticks(from, to, [this](const sim::RecordedTick& tick) { ticks_.push_back(tick); });
  runs_[1]->read_ticks(from, to, [&](const sim::RecordedTick& tick) { compare(ticks_[tick.tick - from], tick); });
  compared_ += to - from + 1;
  return !is_decided() && compared_ < common;
}

void RunComparison::compare(const sim::RecordedTick& tick, const sim::RecordedTick& other) {
  const auto joint = std::ranges::mismatch(tick.setpoints, other.setpoints).in1 - tick.setpoints.begin();
  if (!difference_ && joint < std::ssize(tick.setpoints)) {
    difference_ = {tick.tick, runs_[0]->joint_names()[static_cast<std::size_t>(joint)]};
  }
  if (has_motion_ && !moved_) {
    moved_ = sim::compare_motion(tick.tick, tick.link_poses, other.link_poses, tick.object_poses, other.object_poses);
    moved_part_ = moved_ ? runs_[0]->part_name(*moved_) : "";
  }
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
  json motion;
  if (has_motion_) {
    motion = {{"difference", moved_ ? json{{"tick", moved_->tick}, {"part", moved_part_}} : json()}};
  }
  return {{"first_tick", first_tick()},  {"last_tick", last_tick()},
          {"compared", compared_},       {"difference", std::move(difference)},
          {"motion", std::move(motion)}, {"damage", damage_ ? json(*damage_) : json()},
          {"head_m", std::move(head)}};
}

RecordedSession::RecordedSession(RecordedSessionOptions options, SessionRequests& requests, host::SessionOutput& output)
    : SessionThread(requests, output), folder_(options.folder) {
  output_.publish("recordings", {{"folder", std::filesystem::canonical(options.folder).filename().string()},
                                 {"open", options.file ? json(*options.file) : json()},
                                 {"alone", options.is_alone}});
  begin_thread();
}

RecordedSession::~RecordedSession() { end_thread(); }

void RecordedSession::serve() {
  if (!take_operations() && !work()) {
    requests_.wait();
  }
}

bool RecordedSession::work() {
  for (OpenRun& open : runs_) {
    if (!open.may_have_more) {
      continue;
    }
    try {
      open.may_have_more = open.run->index_some();
    } catch (const std::exception& error) {
      open.run->end_index(one_line(error.what()));
      open.may_have_more = false;
    }
    return true;
  }
  for (OpenComparison& open : comparisons_) {
    if (!open.may_have_more) {
      continue;
    }
    try {
      open.may_have_more = open.comparison.compare_some();
    } catch (const std::exception& error) {
      open.comparison.end(one_line(error.what()));
      open.may_have_more = false;
    }
    return true;
  }
  return folder_.describe_some();
}

json RecordedSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{{"recording.list", &RecordedSession::list},
                                                            {"recording.open", &RecordedSession::open},
                                                            {"recording.rows", &RecordedSession::rows},
                                                            {"recording.compare", &RecordedSession::compare}};
  return (this->*handler_of(handlers, operation.name))(operation.arguments);
}

RecordedSession::OpenRun& RecordedSession::run_of(const json& arguments, const char* argument_name) {
  const auto name = argument<std::string>(arguments, argument_name, "the name of a recording");
  const std::filesystem::path path = folder_.find(name.value_or(""));
  const auto found = std::ranges::find(runs_, path, &OpenRun::path);
  if (found != runs_.end() && found->run->is_current()) {
    runs_.splice(runs_.begin(), runs_, found);
    return runs_.front();
  }
  if (found != runs_.end()) {
    close_run(found);
  }
  runs_.push_front({path, std::make_unique<RecordedRun>(path)});
  if (runs_.size() > max_open_runs) {
    close_run(std::prev(runs_.end()));
  }
  return runs_.front();
}

void RecordedSession::close_run(std::list<OpenRun>::iterator run) {
  std::erase_if(comparisons_, [&](const OpenComparison& open) { return open.comparison.is_of(*run->run); });
  runs_.erase(run);
}

json RecordedSession::list(const json& /*arguments*/) { return {{"files", folder_.list()}}; }

json RecordedSession::open(const json& arguments) {
  OpenRun& open = run_of(arguments);
  open.may_have_more = true;
  return open.run->documents();
}

json RecordedSession::rows(const json& arguments) {
  constexpr const char* tick = "a tick, 0 to 2^32 - 1";
  RecordedRun::Request request;
  request.signals =
      argument<std::vector<std::string>>(arguments, "signals", "names of signals").value_or(request.signals);
  request.from = argument<std::uint32_t>(arguments, "from", tick).value_or(0);
  request.to = argument<std::uint32_t>(arguments, "to", tick).value_or(0);
  request.points = argument<std::uint32_t>(arguments, "points", "a whole number").value_or(request.points);
  return json::binary(run_of(arguments).run->rows(request));
}

json RecordedSession::compare(const json& arguments) {
  OpenRun& first = run_of(arguments);
  const std::filesystem::path path = first.path;
  OpenRun& second = run_of(arguments, "with");
  RecordedRun& other = *second.run;
  // The same file may have been replaced in between: then the first run is closed.
  RecordedRun& run = second.path == path ? other : *first.run;
  const auto found =
      std::ranges::find_if(comparisons_, [&](const OpenComparison& open) { return open.comparison.is_of(run, other); });
  if (found != comparisons_.end()) {
    comparisons_.splice(comparisons_.begin(), comparisons_, found);
  } else {
    comparisons_.push_front({RunComparison(run, other)});
    if (comparisons_.size() > max_comparisons) {
      comparisons_.pop_back();
    }
  }
  comparisons_.front().may_have_more = true;
  return comparisons_.front().comparison.document();
}

}  // namespace proleg::tools
