#include "sim/optimize/experiment/experiment_parts.hpp"

#include <array>
#include <charconv>
#include <concepts>
#include <optional>
#include <type_traits>

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
  std::string text;
  for (const Objective& objective : experiment.objectives) {
    text += SettingsText()
                .add("name", objective.name)
                .add("goal", objective.goal)
                .add("failed", objective.failed)
                .add("terms", terms_text(objective))
                .text() +
            "\n";
  }
  return text + SettingsText().add("heading_deg", experiment.heading_deg).text();
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

}  // namespace

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
  return {{"method",
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
          {"engine", std::string(sim::name_of(experiment.scenario.environment.engine))},
          {"duration", SettingsText().add("seconds", experiment.scenario.duration_s).text()}};
}

}  // namespace proleg::optimize
