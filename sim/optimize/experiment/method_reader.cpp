#include "sim/optimize/experiment/section_readers.hpp"

#include <algorithm>
#include <initializer_list>
#include <span>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::optimize {
namespace {

using sim::Range;
using sim::XmlElement;

constexpr Range probabilities{0.0, 1.0, ""};
constexpr Range method_scores{-1e9, 1e9, ""};
constexpr Range rises{1e-9, 1e9, ""};
constexpr Range step_sizes{1e-6, 1.0, ""};
constexpr std::uint64_t max_candidates = 1'000'000;
constexpr std::uint64_t max_population = 10'000;

/// Tags of <properties> that belong to the search space.
constexpr std::array<std::string_view, 2> registration_tags{"numOfParametersToOptimize", "registeredParameters"};

/// Reads settings by tag; a setting without a tag keeps its value.
class SettingsReader {
 public:
  SettingsReader(const XmlElement& properties, std::span<const std::string_view> tags) : properties_(&properties) {
    properties.allow({}, sim::joined({tags, registration_tags}));
  }

  template <typename Whole>
  void read(std::string_view tag, Whole& value, std::uint64_t lowest, std::uint64_t highest) const {
    if (const auto element = properties_->child(tag)) {
      value = static_cast<Whole>(read_whole(*element, lowest, highest));
    }
  }
  template <typename Number>
  void read(std::string_view tag, Number& value, const Range& range) const {
    if (const auto element = properties_->child(tag)) {
      value = read_number(*element, range);
    }
  }
  /// Reads an enumeration. words: the words for its values, in their order.
  template <typename Enumeration>
  void read(std::string_view tag, Enumeration& value, std::initializer_list<std::string_view> words) const {
    if (const auto element = properties_->child(tag)) {
      value = static_cast<Enumeration>(read_choice(*element, words));
    }
  }

 private:
  const XmlElement* properties_;
};

void read_start(const SettingsReader& settings, Start& start) { settings.read("start", start, {"random", "scenario"}); }

GeneticSettings read_genetic(const XmlElement& properties, std::vector<std::string>& remarks) {
  constexpr std::array<std::string_view, 8> tags{"popsize",      "pmut",           "pcross", "nconvergence",
                                                 "pconvergence", "flushfrequency", "gamode", "start"};
  const SettingsReader settings(properties, tags);
  GeneticSettings genetic;
  settings.read("popsize", genetic.population, 2, max_population);
  settings.read("pmut", genetic.mutation, probabilities);
  settings.read("pcross", genetic.crossover, probabilities);
  settings.read("nconvergence", genetic.generations_to_convergence, 1, 10'000);
  settings.read("pconvergence", genetic.convergence, probabilities);
  settings.read("gamode", genetic.mode, 1, 2);
  genetic.start = Start::scenario;
  read_start(settings, genetic.start);
  if (const auto flush = properties.child("flushfrequency")) {
    remark_no_effect(remarks, *flush, "every evaluation is saved when it is known");
  }
  return genetic;
}

GreatDelugeSettings read_great_deluge(const XmlElement& properties) {
  constexpr std::array<std::string_view, 14> tags{
      "waterLevel", "rain",      "credits", "retries",       "confidence",    "step",   "growth",
      "move",       "neighbour", "start",   "firstMustPass", "reevaluations", "chains", "target"};
  const SettingsReader settings(properties, tags);
  GreatDelugeSettings deluge;
  settings.read("waterLevel", deluge.water_level, method_scores);
  settings.read("rain", deluge.rain, rises);
  settings.read("credits", deluge.credits, 0, max_candidates);
  settings.read("retries", deluge.retries, 1, max_candidates);
  settings.read("confidence", deluge.confidence, 1, max_candidates);
  settings.read("step", deluge.step, 1, max_candidates);
  settings.read("growth", deluge.growth, {"linear", "doubling"});
  settings.read("move", deluge.move, {"all", "one"});
  settings.read("neighbour", deluge.neighbour, {"three", "sign", "uniform"});
  read_start(settings, deluge.start);
  settings.read("firstMustPass", deluge.first_must_pass, 0, 1);
  settings.read("reevaluations", deluge.reevaluations, 0, 100);
  settings.read("chains", deluge.chains, 1, 64);
  settings.read("target", deluge.target, method_scores);
  return deluge;
}

PagmoSettings read_pagmo(const XmlElement& properties, std::string algorithm) {
  const std::vector<std::string> options = pagmo_options(algorithm);
  std::vector<std::string_view> tags{"popsize", "generations", "restartAfter", "start"};
  tags.insert(tags.end(), options.begin(), options.end());
  const SettingsReader settings(properties, tags);
  PagmoSettings pagmo;
  pagmo.algorithm = std::move(algorithm);
  settings.read("popsize", pagmo.population, 2, max_population);
  settings.read("generations", pagmo.generations, 1, max_candidates);
  settings.read("restartAfter", pagmo.restart_after, 0, max_candidates);
  pagmo.start = Start::scenario;
  read_start(settings, pagmo.start);
  settings.read("sigma0", pagmo.sigma0, step_sizes);
  settings.read("crossover", pagmo.crossover, probabilities);
  settings.read("scale", pagmo.scale, probabilities);
  settings.read("mutation", pagmo.mutation, probabilities);
  return pagmo;
}

}  // namespace

MethodSettings read_method(const XmlElement& section, const XmlElement& properties, std::vector<std::string>& remarks) {
  if (section.is("geneticAlgorithm")) {
    return read_genetic(properties, remarks);
  }
  if (section.is("greatDeluge")) {
    return read_great_deluge(properties);
  }
  if (section.is("cmaEs")) {
    return read_pagmo(properties, "cmaes");
  }
  if (section.is("differentialEvolution")) {
    return read_pagmo(properties, "de");
  }
  if (section.is("nsga2")) {
    return read_pagmo(properties, "nsga2");
  }
  return read_pagmo(properties, checked_name(section, section.required_attribute("algorithm")));
}

std::vector<std::string> pagmo_options(std::string_view algorithm) {
  if (algorithm == "cmaes" || algorithm == "xnes") {
    return {"sigma0"};
  }
  if (algorithm == "de") {
    return {"crossover", "scale"};
  }
  if (algorithm == "nsga2" || algorithm == "sga") {
    return {"crossover", "mutation"};
  }
  return {};  // the method has only population and generations
}

std::string method_name(const MethodSettings& method) {
  struct Name {
    std::string operator()(const GreatDelugeSettings& /*settings*/) const { return "great-deluge"; }
    std::string operator()(const GeneticSettings& /*settings*/) const { return "genetic"; }
    std::string operator()(const PagmoSettings& settings) const { return settings.algorithm; }
  };
  return std::visit(Name(), method);
}

}  // namespace proleg::optimize
