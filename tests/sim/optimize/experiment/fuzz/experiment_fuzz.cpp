// Reads arbitrary bytes as an experiment file beside a valid scenario. For all bytes the reader returns an experiment
// that can run, or throws an InputError of one line.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "memory_files.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace {

using namespace proleg;
using namespace proleg::optimize;

void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

void check_message(const InputError& error) {
  const std::string_view message = error.what();
  require(std::ranges::none_of(message, [](char c) { return static_cast<unsigned char>(c) < 0x20; }),
          "a message is one line");
  require(message.find(": found ") != std::string_view::npos, "a message says what was found");
  require(message.find(", expected ") != std::string_view::npos, "a message says what was expected");
}

void check_dimension(const Dimension& dimension, const sim::Scenario& scenario) {
  require(!dimension.targets.empty() && !dimension.values.empty(), "a dimension has targets and values");
  const Setting& first = dimension.targets.front();
  for (const Setting& target : dimension.targets) {
    require(target.slot == first.slot && target.number == first.number && !target.internal,
            "targets are one parameter");
    require(scenario.kernel.slots.at(target.slot).group.contains(target.joint), "targets are driven");
  }
  const Parameter& parameter = scenario.kernel.slots.at(first.slot).algorithm->declaration().parameters[first.number];
  require(parameter.unit == dimension.unit, "a dimension has its parameter's unit");
  for (std::size_t i = 0; i < dimension.values.size(); ++i) {
    const std::int32_t value = dimension.values[i];
    require(value >= parameter.minimum && value <= parameter.maximum, "values are in the declared range");
    require(wraps(dimension.unit) || i == 0 || dimension.values[i - 1] < value, "values ascend");
  }
}

void check_space(const SearchSpace& space, const sim::Scenario& scenario) {
  require(!space.dimensions.empty(), "there is something to choose");
  std::set<std::string> names;
  Candidate last;
  for (const Dimension& dimension : space.dimensions) {
    check_dimension(dimension, scenario);
    require(names.insert(dimension.name).second, "names are unique");
    last.push_back(static_cast<std::uint32_t>(dimension.values.size() - 1));
  }
  require(space.size() >= 1.0, "there is a candidate");
  sim::Scenario chosen = scenario;
  space.apply(last, chosen);
  require(space.nearest(chosen) == last, "a candidate that is applied is the nearest");
}

void check_objectives(const std::vector<Objective>& objectives) {
  require(!objectives.empty(), "there is an objective");
  std::set<std::string> names;
  for (const Objective& objective : objectives) {
    require(names.insert(objective.name).second, "names are unique");
    require(!objective.terms.empty() && std::isfinite(objective.failed), "objectives are complete");
    require(objective.score(sim::MeasureValues()) == objective.failed, "without measures a candidate failed");
  }
}

void check(const Experiment& experiment) {
  check_space(experiment.space, experiment.scenario);
  check_objectives(experiment.objectives);
  require(!method_name(experiment.method).empty(), "a method has a name");
  require(experiment.trials.count >= 1, "there is a trial");
  require(experiment.fingerprint().size() == 64, "an experiment has a fingerprint");
  sim::Scenario trial = experiment.scenario;
  perturb(trial, experiment.trials.spread, experiment.seed);
  for (const sim::Link& link : trial.robot.links) {
    require(link.mass.mass > 0.0, "masses stay above 0");
  }
  require(trial.robot.servo.gain > 0.0 && trial.robot.servo.latency_us <= 100'000, "servos stay servos");
  require(trial.contact_noise >= 0.0 && trial.contact_noise <= 1.0, "a probability stays one");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sim::MemoryFiles files = sim::small_scenario();
  files.texts["fuzz.optimise.xml"] = std::string(reinterpret_cast<const char*>(data), size);
  try {
    check(read_experiment("fuzz.optimise.xml", files));
  } catch (const InputError& error) {
    check_message(error);
  }
  return 0;
}
