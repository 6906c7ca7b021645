#include "small_experiment.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "shared/fixed/decimal.hpp"
#include "shared/gait/actuation_module.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {
namespace {

/// A parameter on all joints, with these values.
Dimension dimension(const sim::Scenario& scenario, const std::string& name, const std::vector<std::string>& values) {
  const Declaration& declaration = scenario.kernel.slots[0].algorithm->declaration();
  Dimension dimension;
  dimension.name = name;
  for (std::size_t i = 0; i < declaration.parameters.size(); ++i) {
    if (declaration.parameters[i].name == name) {
      dimension.unit = declaration.parameters[i].unit;
      for (std::uint8_t joint = 0; joint < scenario.kernel.joint_count; ++joint) {
        dimension.targets.push_back({0, joint, static_cast<std::uint8_t>(i), false, 0});
      }
    }
  }
  for (const std::string& value : values) {
    dimension.values.push_back(parse_decimal(value, dimension.unit).raw);
  }
  return dimension;
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9E3779B97F4A7C15U;
  return hash ^ hash >> 29U;
}

void append(std::string& text, double value) { text += " " + std::to_string(std::bit_cast<std::uint64_t>(value)); }

}  // namespace

Experiment small_experiment(double duration_s) {
  Experiment experiment;
  experiment.path = "small.optimise.xml";
  sim::DiskFiles files;
  experiment.scenario = sim::read_scenario(
      std::filesystem::path(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml")), files);
  experiment.scenario.duration_s = duration_s;
  experiment.space.dimensions = {
      dimension(experiment.scenario, "amplitude", {"10", "20", "30", "40", "50", "60"}),
      dimension(experiment.scenario, "frequency", {"0.5", "1", "1.5", "2"}),
      dimension(experiment.scenario, "phase_difference", {"40", "50", "60", "70"}),
  };
  experiment.objectives = {{"distance", {{sim::Measure::distance, 1.0}}, Goal::maximise, 0.0}};
  experiment.sources = experiment.scenario.sources;
  experiment.sources.insert(experiment.sources.begin(), {experiment.path, "<optimise/>"});
  return experiment;
}

Experiment noisy_experiment(std::uint32_t trials, double duration_s) {
  Experiment experiment = small_experiment(duration_s);
  experiment.trials.count = trials;
  experiment.trials.random_numbers = RandomNumbers::fresh;
  experiment.trials.spread.friction = 0.2;
  return experiment;
}

Candidate random_candidate(const Experiment& experiment, std::mt19937& random) {
  Candidate candidate;
  for (const Dimension& dimension : experiment.space.dimensions) {
    candidate.push_back(static_cast<std::uint32_t>(random() % dimension.values.size()));
  }
  return candidate;
}

TrialResult made_up_trial(const Experiment& experiment, const Task& task) {
  std::uint64_t hash = 1;
  if (depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread)) {
    hash = seed_of(experiment, task);
  }
  for (const std::uint32_t index : task.candidate) {
    hash = mixed(hash, index);
  }
  TrialResult result;
  for (double& value : result.measures.all()) {
    hash = mixed(hash, 7);
    value = static_cast<double>(hash >> 11U) * 0x1p-53;
  }
  result.simulated_s = 0.25;
  result.given_up = task.hopeless_below && experiment.objectives.front().score(result.measures) < *task.hopeless_below;
  if (hash % 16 == 0) {
    result.measures = {};
    result.failure = "made up";
    result.given_up = false;
  }
  return result;
}

RunTasks one_by_one(RunTask run) {
  return [run = std::move(run)](const Experiment& experiment, std::span<const Task> tasks) {
    std::vector<TrialResult> results;
    for (const Task& task : tasks) {
      results.push_back(run(experiment, task));
    }
    return results;
  };
}

void start(Workers& workers, std::uint64_t ticket, const Task& task) {
  const TicketedTask one{ticket, task};
  workers.start({&one, 1});
}

void MadeUpWorkers::start(std::span<const TicketedTask> batch) {
  if (idle() == 0 || batch.empty()) {
    throw std::logic_error(batch.empty() ? "no task" : "no worker is idle");
  }
  for (const TicketedTask& each : batch) {
    started_.push_back(each.task);
  }
  batch_sizes_.push_back(batch.size());
  busy_.emplace_back(batch.begin(), batch.end());
}

std::optional<Workers::Done> MadeUpWorkers::wait(std::chrono::milliseconds /*timeout*/) {
  if ((busy_.empty() && finished_.empty()) || random_() % 3 == 0) {
    return std::nullopt;
  }
  if (finished_.empty()) {
    const auto chosen = static_cast<std::ptrdiff_t>(random_() % busy_.size());
    std::vector<TicketedTask> batch = std::move(busy_[static_cast<std::size_t>(chosen)]);
    busy_.erase(busy_.begin() + chosen);
    std::ranges::shuffle(batch, random_);
    for (const TicketedTask& each : batch) {
      finished_.push_back({each.ticket, run_(experiment_, each.task), static_cast<std::uint32_t>(chosen)});
    }
  }
  Done done = std::move(finished_.front());
  finished_.pop_front();
  return done;
}

std::string exact(const TrialResult& result) {
  std::string text = result.failure + (result.given_up ? " given up" : "");
  append(text, result.simulated_s);
  for (const double value : result.measures.all()) {
    append(text, value);
  }
  return text;
}

std::string exact(const Evaluation& evaluation) {
  std::string text = std::to_string(evaluation.run) + " " + std::to_string(evaluation.number) + " " +
                     evaluation.failure + (evaluation.given_up ? " given up" : "") +
                     (evaluation.reused ? " reused" : "") + ":";
  for (const std::uint32_t index : evaluation.candidate) {
    text += " " + std::to_string(index);
  }
  for (const double score : evaluation.scores) {
    append(text, score);
  }
  append(text, evaluation.simulated_s);
  for (const double value : evaluation.measures.all()) {
    append(text, value);
  }
  return text;
}

}  // namespace proleg::optimize
