#include "tools/proleg/ui/foresight.hpp"

#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"
#include "tools/proleg/common/run_measures.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr double seconds_ahead = 30.0;
constexpr double seconds_between_points = 0.1;

json point_json(const sim::Pose& pose) {
  const auto rounded = [](double metres) { return std::round(metres * 1e4) / 1e4; };  // to 0.1 mm
  return {rounded(pose.position.x()), rounded(pose.position.y()), rounded(pose.position.z())};
}

}  // namespace

Foresight::Foresight(host::SessionOutput& output) : output_(output), thread_([this] { run(); }) {}

Foresight::~Foresight() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Foresight::look_at(std::shared_ptr<const sim::Scenario> scenario, std::uint64_t revision) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ = {std::move(scenario), revision};
    newest_ = revision;
  }
  wake_.notify_one();
}

void Foresight::run() {
  lower_thread_priority();
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return ends_ || waiting_.scenario != nullptr; });
      if (ends_) {
        return;
      }
      task = std::exchange(waiting_, {});
    }
    compute(task);
  }
}

void Foresight::compute(const Task& task) {
  sim::Scenario scenario = *task.scenario;
  json document{{"revision", task.revision}, {"seconds", 0.0},    {"path", json::array()},  {"distance", json()},
                {"heading", json()},         {"failure", json()}, {"servo_problem", json()}};
  std::unique_ptr<sim::Simulation> simulation;
  try {
    simulation = make_fast_simulation(scenario);
    const double tick_s = scenario.kernel.tick_period_us * 1e-6;
    const auto ticks = static_cast<std::uint32_t>(std::lround(seconds_ahead / tick_s));
    const auto ticks_of_point = std::max(1L, std::lround(seconds_between_points / tick_s));
    json& path = document["path"];
    path.push_back(point_json(simulation->plant().link_poses().front()));
    while (simulation->tick() < ticks && !is_outdated(task)) {
      simulation->advance();
      if (simulation->tick() % static_cast<std::uint32_t>(ticks_of_point) == 0) {
        path.push_back(point_json(simulation->plant().link_poses().front()));
      }
    }
  } catch (const std::exception& error) {
    document["failure"] = one_line(error.what());
  }
  if (is_outdated(task)) {
    return;
  }
  document["engine"] = sim::name_of(scenario.environment.engine);
  if (simulation != nullptr && simulation->tick() > 0) {
    document["seconds"] = simulation->time_s();
    const sim::MeasureValues values = simulation->measures();
    const auto value = [&](sim::Measure measure) {
      return std::isfinite(values[measure]) ? json(values[measure]) : json();
    };
    document["distance"] = value(sim::Measure::distance);
    document["heading"] = value(sim::Measure::heading);
    document["servo_problem"] = text_or_null(servo_problem(simulation->plant().meter().tracking(), scenario.robot));
  }
  output_.publish("foresight", document);
}

}  // namespace proleg::tools
