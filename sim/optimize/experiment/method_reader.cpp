#include <algorithm>
#include <concepts>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"
#include "sim/optimize/experiment/section_readers.hpp"
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

std::string usual_text(double value) { return exact_text(value); }
std::string usual_text(const std::optional<double>& value) { return value ? exact_text(*value) : std::string(); }
template <typename Whole>
std::string usual_text(Whole value) {
  return std::to_string(static_cast<std::uint64_t>(value));
}

/// The settings of a method with the members that they set.
template <typename Settings>
class SettingTable {
 public:
  /// usual: the settings of a file that has none of the tags.
  explicit SettingTable(Settings usual) : usual_(std::move(usual)) {}

  template <typename Whole>
  void add_whole(std::string_view tag, Whole Settings::*member, std::uint64_t lowest, std::uint64_t highest,
                 std::string_view help) {
    add({tag,
         MethodSetting::Kind::whole,
         static_cast<double>(lowest),
         static_cast<double>(highest),
         {},
         usual_text(usual_.*member),
         help},
        [=](const XmlElement& element, Settings& settings) {
          settings.*member = static_cast<Whole>(read_whole(element, lowest, highest));
        });
  }
  template <typename Number>
  void add_number(std::string_view tag, Number Settings::*member, const Range& range, std::string_view help) {
    add({tag, MethodSetting::Kind::number, range.min, range.max, {}, usual_text(usual_.*member), help},
        [=](const XmlElement& element, Settings& settings) { settings.*member = read_number(element, range); });
  }
  /// words: for the values of the enumeration, in their order.
  template <typename Enumeration>
  void add_choice(std::string_view tag, Enumeration Settings::*member, std::initializer_list<std::string_view> words,
                  std::string_view help) {
    const std::vector<std::string_view> choices(words);
    const std::string usual(choices[static_cast<std::size_t>(usual_.*member)]);
    add({tag, MethodSetting::Kind::choice, 0.0, 0.0, choices, usual, help},
        [=](const XmlElement& element, Settings& settings) {
          settings.*member = static_cast<Enumeration>(read_choice(element, choices));
        });
  }

  [[nodiscard]] const std::vector<MethodSetting>& declarations() const { return declarations_; }

  /// Reads the settings of <properties>. The registered parameters there are read elsewhere. other_tags: tags without
  /// effect.
  [[nodiscard]] Settings read(const XmlElement& properties, std::span<const std::string_view> other_tags = {}) const {
    std::vector<std::string_view> tags;
    for (const MethodSetting& declaration : declarations_) {
      tags.push_back(declaration.tag);
    }
    properties.allow({}, sim::joined({tags, other_tags, registration_tags}));
    Settings settings = usual_;
    for (std::size_t i = 0; i < declarations_.size(); ++i) {
      if (const auto element = properties.child(declarations_[i].tag)) {
        readers_[i](*element, settings);
      }
    }
    return settings;
  }

 private:
  using Reader = std::function<void(const XmlElement&, Settings&)>;

  void add(MethodSetting declaration, Reader reader) {
    declarations_.push_back(std::move(declaration));
    readers_.push_back(std::move(reader));
  }

  Settings usual_;
  std::vector<MethodSetting> declarations_;
  std::vector<Reader> readers_;
};

constexpr std::string_view start_help =
    "where the search starts: at random candidates only, or with the scenario's "
    "own values among the first ones";

template <typename Settings>
void add_start(SettingTable<Settings>& table) {
  table.add_choice("start", &Settings::start, {"random", "scenario"}, start_help);
}

const SettingTable<GeneticSettings>& genetic_table() {
  static const SettingTable<GeneticSettings> table = [] {
    using Settings = GeneticSettings;
    Settings usual;
    usual.start = Start::scenario;
    SettingTable<Settings> made(usual);
    made.add_whole("popsize", &Settings::population, 2, max_population, "candidates of a generation");
    made.add_number("pmut", &Settings::mutation, probabilities,
                    "probability that a value of a candidate is drawn anew");
    made.add_number("pcross", &Settings::crossover, probabilities, "probability that two candidates are crossed");
    made.add_whole("nconvergence", &Settings::generations_to_convergence, 1, 10'000,
                   "generations over which convergence is judged");
    made.add_number("pconvergence", &Settings::convergence, probabilities,
                    "the search ends when the best score of so many generations ago is this share of the best now");
    made.add_whole(
        "gamode", &Settings::mode, 1, 2,
        "1: a whole new generation each time, of which the best survives; 2: half of each generation is new");
    add_start(made);
    return made;
  }();
  return table;
}

const SettingTable<GreatDelugeSettings>& great_deluge_table() {
  static const SettingTable<GreatDelugeSettings> table = [] {
    using Settings = GreatDelugeSettings;
    SettingTable<Settings> made{Settings{}};
    made.add_number("waterLevel", &Settings::water_level, method_scores,
                    "score that the first accepted candidate must reach");
    made.add_number("rain", &Settings::rain, rises, "rise of the water level with each accepted candidate");
    made.add_whole("credits", &Settings::credits, 0, max_candidates,
                   "how often the search may start over with its first radius");
    made.add_whole("retries", &Settings::retries, 1, max_candidates, "failures in a row that use up a credit");
    made.add_whole("confidence", &Settings::confidence, 1, max_candidates,
                   "the radius grows each time the search has had so many failures");
    made.add_whole("step", &Settings::step, 1, max_candidates, "first radius, in steps of each value set");
    made.add_choice("growth", &Settings::growth, {"linear", "doubling"},
                    "how the radius grows each time: by the first radius, or to twice its value");
    made.add_choice("move", &Settings::move, {"all", "one"}, "parameters that a new candidate changes");
    made.add_choice("neighbour", &Settings::neighbour, {"three", "sign", "uniform"},
                    "how far a parameter moves: by -r, 0 or r; by -r or r; by any step from -r to r");
    add_start(made);
    made.add_whole("firstMustPass", &Settings::first_must_pass, 0, 1,
                   "1: the first candidate must reach the water level");
    made.add_whole("reevaluations", &Settings::reevaluations, 0, 100,
                   "further evaluations of a candidate that would be accepted; the mean decides");
    made.add_whole("chains", &Settings::chains, 1, 64, "searches side by side, each with its own water level");
    made.add_number("target", &Settings::target, method_scores, "the search ends when a score reaches this value");
    return made;
  }();
  return table;
}

SettingTable<PagmoSettings> make_pagmo_table(std::string_view algorithm) {
  using Settings = PagmoSettings;
  Settings usual;
  usual.algorithm = algorithm;
  usual.start = Start::scenario;
  SettingTable<Settings> made(usual);
  made.add_whole("popsize", &Settings::population, 2, max_population, "candidates of a generation");
  made.add_whole("generations", &Settings::generations, 1, max_candidates, "generations at most");
  made.add_whole("restartAfter", &Settings::restart_after, 0, max_candidates,
                 "generations in which the best score improves by less than a thousandth until the search restarts; 0: "
                 "it never restarts");
  add_start(made);
  const std::vector<std::string> options = pagmo_options(algorithm);
  const auto add_option = [&](const char* tag, std::optional<double> Settings::*member, const Range& range,
                              std::string_view help) {
    if (std::ranges::find(options, tag) != options.end()) {
      made.add_number(tag, member, range, help);
    }
  };
  add_option("sigma0", &Settings::sigma0, step_sizes, "first step size, as a share of the ranges");
  add_option("crossover", &Settings::crossover, probabilities,
             "probability that a value is taken from another candidate");
  add_option("scale", &Settings::scale, probabilities, "weight of the difference between two candidates (F)");
  add_option("mutation", &Settings::mutation, probabilities, "probability that a value is changed");
  return made;
}

/// A name that is unknown to pagmo has the settings that all its algorithms have; check_method() refuses it.
const SettingTable<PagmoSettings>& pagmo_table(const std::string& algorithm) {
  static const std::map<std::string, SettingTable<PagmoSettings>, std::less<>> tables = [] {
    std::map<std::string, SettingTable<PagmoSettings>, std::less<>> made;
    for (const PagmoDeclaration& declaration : pagmo_declarations()) {
      made.emplace(declaration.name, make_pagmo_table(declaration.name));
    }
    return made;
  }();
  static const SettingTable<PagmoSettings> unknown = make_pagmo_table("");
  const auto found = tables.find(algorithm);
  return found == tables.end() ? unknown : found->second;
}

const SettingTable<MapElitesSettings>& map_elites_table() {
  static const SettingTable<MapElitesSettings> table = [] {
    using Settings = MapElitesSettings;
    SettingTable<Settings> made{Settings{}};
    made.add_whole("popsize", &Settings::population, 1, max_population, "candidates of a generation");
    made.add_whole("generations", &Settings::generations, 1, max_candidates, "generations at most, after the first");
    made.add_whole("first", &Settings::first, 1, max_candidates, "candidates of the first generation, drawn at random");
    made.add_number("noise", &Settings::noise, probabilities,
                    "standard deviation of the noise on each value, as a share of its range");
    made.add_number("line", &Settings::line, probabilities,
                    "standard deviation of the step towards or from another candidate of the map, as a share of the "
                    "distance to it");
    made.add_whole("centroids", &Settings::centroids, 0, max_centroids,
                   "cells of about equal size, whatever the number of axes; 0: a grid, with the cells of each axis");
    add_start(made);
    return made;
  }();
  return table;
}

PagmoSettings read_pagmo(const XmlElement& properties, const std::string& algorithm) {
  PagmoSettings settings = pagmo_table(algorithm).read(properties);
  settings.algorithm = algorithm;
  return settings;
}

GeneticSettings read_genetic(const XmlElement& properties, std::vector<std::string>& remarks) {
  constexpr std::array<std::string_view, 1> without_effect{"flushfrequency"};
  GeneticSettings genetic = genetic_table().read(properties, without_effect);
  if (const auto flush = properties.child(without_effect.front())) {
    remark_no_effect(remarks, *flush, "every evaluation is saved when it is known");
  }
  return genetic;
}

/// The algorithms of pagmo with sections of their own.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> pagmo_sections{
    {{"cmaEs", "cmaes"}, {"differentialEvolution", "de"}, {"nsga2", "nsga2"}}};

}  // namespace

MethodSettings read_method(const XmlElement& section, const XmlElement& properties, std::vector<std::string>& remarks) {
  if (section.is("geneticAlgorithm")) {
    return read_genetic(properties, remarks);
  }
  if (section.is("greatDeluge")) {
    return great_deluge_table().read(properties);
  }
  if (section.is("mapElites")) {
    return map_elites_table().read(properties);
  }
  for (const auto& [tag, algorithm] : pagmo_sections) {
    if (section.is(tag)) {
      return read_pagmo(properties, std::string(algorithm));
    }
  }
  return read_pagmo(properties, checked_name(section, section.required_attribute("algorithm")));
}

const std::vector<MethodDeclaration>& methods() {
  static const std::vector<MethodDeclaration> all = [] {
    std::vector<MethodDeclaration> made;
    const auto add_pagmo = [&](const PagmoDeclaration& its, std::string_view tag) {
      made.push_back({tag, tag == "pagmo" ? its.name : std::string_view(), its.title, its.help, its.objectives, false,
                      pagmo_table(std::string(its.name)).declarations()});
    };
    const auto section_of = [](const PagmoDeclaration& its) {
      return std::ranges::find(pagmo_sections, its.name, &std::pair<std::string_view, std::string_view>::second);
    };
    for (const auto& [tag, algorithm] : pagmo_sections) {
      add_pagmo(*std::ranges::find(pagmo_declarations(), algorithm, &PagmoDeclaration::name), tag);
    }
    made.push_back(
        {"greatDeluge", "", "Great deluge",
         "the thesis's method: it accepts what is above a water level that rises; few settings, steady progress",
         ObjectiveCount::one, false, great_deluge_table().declarations()});
    made.push_back(
        {"geneticAlgorithm", "", "Genetic algorithm",
         "the thesis's other method, of GAlib: crosses and mutates candidates; for sets of values without an order",
         ObjectiveCount::one, false, genetic_table().declarations()});
    made.push_back(
        {"mapElites", "", "MAP-Elites",
         "fills a map over measures of the run with the best gait of each kind: many different gaits, not one",
         ObjectiveCount::one, true, map_elites_table().declarations()});
    for (const PagmoDeclaration& its : pagmo_declarations()) {
      if (section_of(its) == pagmo_sections.end()) {
        add_pagmo(its, "pagmo");
      }
    }
    return made;
  }();
  return all;
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
    std::string operator()(const MapElitesSettings& /*settings*/) const { return "map-elites"; }
  };
  return std::visit(Name(), method);
}

}  // namespace proleg::optimize
