#include "tools/proleg/ui/foresight.hpp"

#include <algorithm>
#include <chrono>
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
constexpr double seconds_of_first_part = 10.0;
constexpr auto time_for_old = std::chrono::milliseconds(80);  // so that a slow engine shows ten parts a second, too

std::uint32_t ticks_in(double seconds, const sim::Scenario& scenario) {
  return static_cast<std::uint32_t>(std::lround(seconds * 1e6 / scenario.kernel.tick_period_us));
}

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
  json document{{"revision", task.revision}, {"is_complete", false},    {"seconds", 0.0},
                {"path", json::array()},     {"distance", json()},      {"heading", json()},
                {"failure", json()},         {"servo_problem", json()}, {"refusal", json()}};
  std::unique_ptr<sim::Simulation> simulation;
  const auto publish = [&] {
    document["engine"] = sim::name_of(scenario.environment.engine);
    document["seconds"] = simulation != nullptr ? simulation->time_s() : 0.0;
    output_.publish("foresight", document);
  };
  const auto begin = std::chrono::steady_clock::now();
  const auto is_late = [&begin] { return std::chrono::steady_clock::now() - begin > time_for_old; };
  try {
    simulation = make_fast_simulation(scenario);
    if (scenario.environment.engine != task.scenario->environment.engine &&
        task.scenario->environment.engine == sim::PhysicsEngine::reduced) {
      document["refusal"] = refusal_of_engine(*task.scenario).value_or("");
    }
    const std::uint32_t ticks = ticks_in(seconds_ahead, scenario);
    const std::uint32_t ticks_of_point = std::max(1U, ticks_in(seconds_between_points, scenario));
    const std::uint32_t ticks_of_first_part = ticks_in(seconds_of_first_part, scenario);
    bool has_first_part = false;
    json& path = document["path"];
    path.push_back(point_json(simulation->plant().link_poses().front()));
    while (simulation->tick() < ticks) {
      if (ends_ || (is_outdated(task) && has_first_part && is_late())) {
        return;
      }
      simulation->advance();
      if (simulation->tick() % ticks_of_point != 0) {
        continue;
      }
      path.push_back(point_json(simulation->plant().link_poses().front()));
      if (!has_first_part && (simulation->tick() >= ticks_of_first_part || is_late())) {
        has_first_part = true;
        publish();
      }
    }
  } catch (const std::exception& error) {
    document["failure"] = one_line(error.what());
  }
  if (simulation != nullptr && simulation->tick() > 0) {
    const sim::MeasureValues values = simulation->measures();
    const auto value = [&](sim::Measure measure) {
      return std::isfinite(values[measure]) ? json(values[measure]) : json();
    };
    document["distance"] = value(sim::Measure::distance);
    document["heading"] = value(sim::Measure::heading);
    document["servo_problem"] = text_or_null(servo_problem(simulation->plant().meter().tracking(), scenario.robot));
  }
  document["is_complete"] = true;
  publish();
}

}  // namespace proleg::tools
