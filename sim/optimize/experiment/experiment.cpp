#include "sim/optimize/experiment/experiment.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <optional>
#include <string_view>
#include <type_traits>

#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/overrides.hpp"

namespace proleg::optimize {
namespace {

/// A text "name=value name=value ...".
class SettingsText {
 public:
  template <typename Number>
  requires std::integral<Number> || std::floating_point<Number> SettingsText& add(const char* name, Number value) {
    std::array<char, 32> text{};
    char* const end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return add(name, std::string(text.data(), end));
  }
  SettingsText& add(const char* name, bool value) { return add(name, std::string(value ? "yes" : "no")); }
  SettingsText& add(const char* name, const std::optional<double>& value) {
    return value ? add(name, *value) : add(name, std::string("none"));
  }
  SettingsText& add(const char* name, const std::string& value) {
    text_ += (text_.empty() ? "" : " ") + std::string(name) + "=" + value;
    return *this;
  }
  /// Writes an enumeration's value as a number: the texts are only compared.
  template <typename Enumeration>
  requires std::is_enum_v<Enumeration> SettingsText& add(const char* name, Enumeration value) {
    return add(name, static_cast<int>(value));
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string method_text(const GreatDelugeSettings& method) {
  return SettingsText()
      .add("water_level", method.water_level)
      .add("rain", method.rain)
      .add("credits", method.credits)
      .add("retries", method.retries)
      .add("confidence", method.confidence)
      .add("step", method.step)
      .add("growth", method.growth)
      .add("move", method.move)
      .add("neighbour", method.neighbour)
      .add("start", method.start)
      .add("first_must_pass", method.first_must_pass)
      .add("reevaluations", method.reevaluations)
      .add("chains", method.chains)
      .add("target", method.target)
      .text();
}

std::string method_text(const GeneticSettings& method) {
  return SettingsText()
      .add("population", method.population)
      .add("mutation", method.mutation)
      .add("crossover", method.crossover)
      .add("generations_to_convergence", method.generations_to_convergence)
      .add("convergence", method.convergence)
      .add("mode", method.mode)
      .add("start", method.start)
      .text();
}

std::string method_text(const PagmoSettings& method) {
  return SettingsText()
      .add("population", method.population)
      .add("generations", method.generations)
      .add("restart_after", method.restart_after)
      .add("start", method.start)
      .add("sigma0", method.sigma0)
      .add("crossover", method.crossover)
      .add("scale", method.scale)
      .add("mutation", method.mutation)
      .text();
}

std::string method_text(const MapElitesSettings& method) {
  SettingsText text;
  text.add("population", method.population)
      .add("generations", method.generations)
      .add("first", method.first)
      .add("noise", method.noise)
      .add("line", method.line)
      .add("start", method.start);
  if (method.centroids > 0) {  // stores of grids, which earlier versions made, have no such setting
    text.add("centroids", method.centroids);
  }
  return text.text();
}

/// The texts of some items, a line each.
template <typename Items, typename TextOf>
std::string lines_of(const Items& items, const TextOf& text_of) {
  std::string text;
  for (const auto& item : items) {
    text += text_of(item) + "\n";
  }
  return text;
}

std::string axes_text(const std::vector<MapAxis>& axes) {
  return lines_of(axes, [](const MapAxis& axis) {
    return SettingsText()
        .add("measure", std::string(sim::declaration_of(axis.measure).name))
        .add("lowest", axis.lowest)
        .add("highest", axis.highest)
        .add("cells", axis.cells)
        .text();
  });
}

std::string space_text(const SearchSpace& space) {
  std::string text;
  for (const Dimension& dimension : space.dimensions) {
    text += dimension.name;
    for (const std::int32_t value : dimension.values) {
      text += " ";
      text += format_decimal(value, dimension.unit).view();
    }
    text += "\n";
  }
  return text;
}

std::string objectives_text(const Experiment& experiment) {
  return lines_of(experiment.objectives,
                  [](const Objective& objective) {
                    return SettingsText()
                        .add("name", objective.name)
                        .add("goal", objective.goal)
                        .add("failed", objective.failed)
                        .add("terms", terms_text(objective))
                        .text();
                  }) +
         SettingsText().add("heading_deg", experiment.heading_deg).text();
}

std::string trials_text(const Trials& trials) {
  return SettingsText()
      .add("count", trials.count)
      .add("aggregate", trials.aggregate)
      .add("random_numbers", trials.random_numbers)
      .add("friction", trials.spread.friction)
      .add("mass", trials.spread.mass)
      .add("servo_gain", trials.spread.servo_gain)
      .add("latency_ms", trials.spread.latency_ms)
      .add("contact_noise", trials.spread.contact_noise)
      .text();
}

/// A text that is equal for two experiments only if the experiments are equal: each item has a mark at its end.
class CanonicalText {
 public:
  void add(std::string_view text) {
    text_ += std::to_string(text.size());
    text_ += ':';
    text_ += text;
  }
  void add(double number) { add(std::string_view(exact_text(number))); }
  template <typename Whole>
  requires std::is_integral_v<Whole>
  void add(Whole number) {
    text_ += std::to_string(number);
    text_ += ';';
  }
  void add(sim::Solver solver) { add(static_cast<int>(solver)); }
  void add(sim::PhysicsEngine engine) { add(static_cast<int>(engine)); }
  template <typename... Items>
  void add_all(const Items&... items) {
    (add(items), ...);
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void add_setting(CanonicalText& text, const Setting& setting) {
  text.add_all(setting.slot, setting.joint, setting.number, setting.internal, setting.value);
}

/// Adds the texts of the files, and the settings that the command line may change.
void add_scenario(CanonicalText& text, const sim::Scenario& scenario) {
  text.add(scenario.sources.size());
  for (const sim::SourceFile& source : scenario.sources) {
    text.add(std::string_view(source.text));
  }
  text.add_all(scenario.duration_s, scenario.step_s, scenario.environment.engine, scenario.solver,
               scenario.contact_noise, scenario.kernel.tick_period_us, scenario.kernel.seed, scenario.settings.size(),
               scenario.changes.size());
  for (const Slot& slot : scenario.kernel.slots) {
    if (slot.algorithm != nullptr && slot.algorithm->declaration().sources != 0) {
      text.add(slot.algorithm->declaration().sources);
    }
  }
  for (const Setting& setting : scenario.settings) {
    add_setting(text, setting);
  }
  for (const Change& change : scenario.changes) {
    text.add_all(change.tick, change.settings.size());
    for (const Setting& setting : change.settings) {
      add_setting(text, setting);
    }
  }
}

double sum_of(const std::vector<Term>& terms, const sim::MeasureValues& measures) {
  double sum = 0.0;
  for (const Term& term : terms) {
    sum += term.weight * measures[term.measure];
  }
  return sum;
}

}  // namespace

bool Objective::is_defined(const sim::MeasureValues& measures) const { return std::isfinite(sum_of(terms, measures)); }

double Objective::score(const sim::MeasureValues& measures) const {
  return is_defined(measures) ? sum_of(terms, measures) : failed;
}

bool Objective::may_be_negative() const {
  return failed < 0.0 || std::ranges::any_of(terms, [](const Term& term) {
           return term.weight < 0.0 || sim::declaration_of(term.measure).may_be_negative;
         });
}

std::string_view Objective::unit() const {
  const bool is_measure = terms.size() == 1 && terms.front().weight == 1.0;
  return is_measure ? sim::declaration_of(terms.front().measure).unit : std::string_view();
}

std::string terms_text(const Objective& objective) {
  std::string text;
  for (const Term& term : objective.terms) {
    std::array<char, 32> weight{};
    char* const end = std::to_chars(weight.data(), weight.data() + weight.size(), term.weight).ptr;
    text += text.empty() ? "" : " + ";
    text.append(weight.data(), end);
    text += " * ";
    text += sim::declaration_of(term.measure).name;
  }
  return text;
}

std::vector<ExperimentPart> parts_of(const Experiment& experiment) {
  std::vector<ExperimentPart> parts{
      {"method",
       std::visit([&](const auto& method) { return method_name(experiment.method) + " " + method_text(method); },
                  experiment.method)},
      {"seed", SettingsText().add("seed", experiment.seed).text()},
      {"search space", space_text(experiment.space)},
      {"fitness", objectives_text(experiment)},
      {"trials", trials_text(experiment.trials)},
      {"racing", SettingsText().add("after", experiment.racing.after).add("keep", experiment.racing.keep).text()},
      {"confirmation", SettingsText()
                           .add("candidates", experiment.confirmation.candidates)
                           .add("runs", experiment.confirmation.runs)
                           .text()},
      {"baseline", SettingsText().add("has_baseline", experiment.has_baseline).text()},
      {"reuse", SettingsText().add("reuse", experiment.reuse).text()},
      {"engine", std::string(trial_maker(experiment))},
      {"duration", SettingsText().add("seconds", experiment.scenario.duration_s).text()}};
  if (!experiment.axes.empty()) {  // stores of other methods, which earlier versions made, have no such part
    parts.push_back({"map", axes_text(experiment.axes)});
  }
  if (!experiment.simulated_robot.empty()) {
    parts.push_back({simulated_robot_part, experiment.simulated_robot});
  }
  return parts;
}

void set_trials(Experiment& experiment, std::uint32_t count) {
  Trials& trials = experiment.trials;
  trials.count = count;
  if (count > 1 && !experiment.on_robot && !depends_on_seed(experiment.scenario, experiment.space, trials.spread)) {
    trials.spread = usual_spread();
  }
}

void put_on_robot(Experiment& experiment, const std::string& simulated) {
  experiment.on_robot = true;
  experiment.simulated_robot = simulated;
  experiment.trials.spread = {};
  experiment.racing = {};
}

std::string_view trial_maker(const Experiment& experiment) {
  return experiment.on_robot ? robot_name : sim::name_of(experiment.scenario.environment.engine);
}

std::uint64_t planned_evaluations(const Experiment& experiment) {
  std::uint64_t all = experiment.has_baseline ? 1 : 0;
  if (const auto* const pagmo = std::get_if<PagmoSettings>(&experiment.method)) {
    all += (std::uint64_t{pagmo->generations} + 1) * pagmo->population;
  } else if (const auto* const map = std::get_if<MapElitesSettings>(&experiment.method)) {
    all += map->first + std::uint64_t{map->generations} * map->population;
  } else {
    return experiment.evaluations;
  }
  return experiment.evaluations == 0 ? all : std::min(all, experiment.evaluations);
}

std::string Experiment::fingerprint() const {
  CanonicalText text;
  for (const ExperimentPart& part : parts_of(*this)) {
    text.add(std::string_view(part.text));
  }
  add_scenario(text, scenario);
  return sha256_hex(text.text());
}

}  // namespace proleg::optimize
