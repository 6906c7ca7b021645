#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"
#include "sim/optimize/experiment/section_readers.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/values.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {
namespace {

using sim::Range;
using sim::XmlElement;

using sim::XmlElement;

constexpr sim::Range weights{-1e9, 1e9, ""};
constexpr sim::Range score_range{-1e12, 1e12, ""};
constexpr double worst_cost = 1e6;

sim::Measure read_measure(const XmlElement& element) {
  const std::string name = element.required_attribute("measure");
  const std::optional<sim::Measure> measure = sim::find_measure(name);
  if (!measure) {
    element.refuse("unknown measure " + in_quotes(name), "one of " + listed(sim::measure_names()));
  }
  return *measure;
}

Term read_term(const XmlElement& element) {
  element.allow({"measure", "weight"}, {});
  Term term;
  term.measure = read_measure(element);
  if (element.attribute("weight")) {
    term.weight = read_number_attribute(element, "weight", weights);
  }
  if (term.weight == 0.0) {
    element.refuse("weight 0 in " + element.label(), "a weight other than 0, or no such term");
  }
  return term;
}

std::vector<Term> read_terms(const XmlElement& objective) {
  std::vector<Term> terms;
  for (const XmlElement& child : objective.children()) {
    const Term term = read_term(child);
    if (std::ranges::find(terms, term.measure, &Term::measure) != terms.end()) {
      child.refuse("a second term with measure " + in_quotes(declaration_of(term.measure).name), "one");
    }
    terms.push_back(term);
  }
  if (objective.attribute("measure")) {
    if (!terms.empty()) {
      objective.refuse("attribute 'measure' and <term>s in " + objective.label(), "one or the other");
    }
    terms.push_back({read_measure(objective), 1.0});
  }
  if (terms.empty()) {
    objective.refuse("no <term> in " + objective.label(), "at least one, or an attribute 'measure'");
  }
  return terms;
}

/// The goal if the file gives none: a single measure has a natural one, a sum is maximised.
Goal natural_goal(const std::vector<Term>& terms) {
  if (terms.size() > 1) {
    return Goal::maximise;
  }
  const bool rises = declaration_of(terms.front().measure).higher_is_better == (terms.front().weight > 0.0);
  return rises ? Goal::maximise : Goal::minimise;
}

/// The score of a failed run if the file gives none. It must be worse than that of any other run, which is known only
/// of a single measure.
double natural_failed(const XmlElement& element, const Objective& objective) {
  const Term& first = objective.terms.front();
  const bool is_maximised = objective.goal == Goal::maximise;
  const sim::MeasureDeclaration& measure = declaration_of(first.measure);
  if (objective.terms.size() > 1) {
    element.refuse("a sum of measures without 'failed' in " + element.label(),
                   "failed=\"...\", the score of a run that fails, worse than that of every other run");
  }
  if (is_maximised && (first.weight < 0.0 || measure.may_be_negative)) {
    element.refuse(
        "a score that may be negative (" + std::string(measure.name) + ") without 'failed' in " + element.label(),
        "failed=\"...\", the score of a run that fails, worse than that of every other run");
  }
  return is_maximised ? 0.0 : worst_cost;
}

Objective read_objective(const XmlElement& element) {
  element.allow({"name", "goal", "failed", "measure"}, {"term"});
  Objective objective;
  objective.terms = read_terms(element);
  objective.goal = element.attribute("goal")
                       ? static_cast<Goal>(read_choice_attribute(element, "goal", {"maximise", "minimise"}))
                       : natural_goal(objective.terms);
  if (const auto name = element.attribute("name")) {
    objective.name = checked_name(element, *name);
  } else {
    objective.name =
        objective.terms.size() == 1 ? std::string(declaration_of(objective.terms.front().measure).name) : "score";
  }
  objective.failed = element.attribute("failed") ? read_number_attribute(element, "failed", score_range)
                                                 : natural_failed(element, objective);
  return objective;
}

/// Reads the 1 to 8 <objective>s of a <fitness>: each has one measure (`measure`) or a weighted sum (<term>s).
std::vector<Objective> read_objectives(const XmlElement& fitness) {
  std::vector<Objective> objectives;
  for (const XmlElement& child : fitness.children()) {
    if (child.is("axis")) {
      continue;
    }
    Objective objective = read_objective(child);
    if (std::ranges::find(objectives, objective.name, &Objective::name) != objectives.end()) {
      child.refuse("a second objective " + in_quotes(objective.name), "another name");
    }
    if (objectives.size() == max_objectives) {
      child.refuse("more than " + std::to_string(max_objectives) + " objectives",
                   "at most " + std::to_string(max_objectives));
    }
    objectives.push_back(std::move(objective));
  }
  if (objectives.empty()) {
    fitness.refuse("no <objective> in " + fitness.label(), "at least one");
  }
  return objectives;
}

/// centroids: of the map; 0: a grid.
MapAxis read_axis(const XmlElement& element, std::uint32_t centroids) {
  element.allow({"measure", "lowest", "highest", "cells"}, {});
  MapAxis axis;
  axis.measure = read_measure(element);
  axis.lowest = read_number_attribute(element, "lowest", score_range);
  axis.highest = read_number_attribute(element, "highest", score_range);
  if (axis.highest <= axis.lowest) {
    element.refuse("highest " + number_text(axis.highest) + " in " + element.label(),
                   "more than lowest, which is " + number_text(axis.lowest));
  }
  if (centroids == 0) {
    axis.cells = static_cast<std::uint32_t>(read_whole_attribute(element, "cells", 2, max_map_cells));
    return axis;
  }
  axis.cells = 0;
  if (element.attribute("cells")) {
    element.refuse("cells in " + element.label() + " of a map with " + std::to_string(centroids) + " centroids",
                   "none: an axis has cells in a grid only");
  }
  return axis;
}

/// Reads the axes of a map, and adds their measures to the objectives.
void read_axes(const XmlElement& fitness, Experiment& experiment) {
  const auto* const settings = std::get_if<MapElitesSettings>(&experiment.method);
  for (const XmlElement& child : fitness.children()) {
    if (!child.is("axis")) {
      continue;
    }
    const MapAxis axis = read_axis(child, settings == nullptr ? 0 : settings->centroids);
    Objective measured;
    measured.name = declaration_of(axis.measure).name;
    measured.terms.push_back({axis.measure, 1.0});
    measured.failed = score_range.min;
    if (std::ranges::find(experiment.objectives, measured.name, &Objective::name) != experiment.objectives.end()) {
      child.refuse("a second " + in_quotes(measured.name) + " among objective and axes",
                   "another measure, or another name for the objective");
    }
    experiment.axes.push_back(axis);
    experiment.objectives.push_back(std::move(measured));
  }
}

/// The objective of a file without <fitness>, or with axes only: the distance, as in the thesis.
std::vector<Objective> default_objectives() {
  Objective distance;
  distance.name = declaration_of(sim::Measure::distance).name;
  distance.terms.push_back({sim::Measure::distance, 1.0});
  return {distance};
}

constexpr Range headings{-360.0, 360.0, "degrees"};
constexpr Range spreads{0.0, 0.9, ""};
constexpr Range latencies{0.0, 100.0, "ms"};
constexpr Range shares{0.0, 1.0, ""};
constexpr Range part_runs{0.0, 0.99, ""};
constexpr std::uint64_t max_evaluations = 1'000'000'000;

sim::Scenario read_named_scenario(const XmlElement& section, const std::filesystem::path& path, sim::FileSource& files,
                                  const std::optional<std::filesystem::path>& simulation) {
  if (simulation) {
    return read_scenario(*simulation, files);
  }
  const auto mention = section.child("simulation");
  if (!mention) {
    section.refuse("no <simulation> in " + section.label(), "the scenario, named there or with --simulation");
  }
  // The file is opened here first, so that the message for a missing file names this line.
  std::vector<sim::SourceFile> record;
  const std::filesystem::path found = sim::SourceSet(files, path, record).open(*mention, mention->text())->path();
  return read_scenario(found, files);
}

double read_spread(const XmlElement& trials, std::string_view tag, const Range& range) {
  const auto element = trials.child(tag);
  return element ? read_quantity(*element, range) : 0.0;
}

Trials read_trials(const XmlElement& element) {
  element.allow({"count", "aggregate", "randomNumbers"}, {"friction", "mass", "servoGain", "latency", "contactNoise"});
  Trials trials;
  trials.count = static_cast<std::uint32_t>(read_whole_attribute(element, "count", 1, max_trials));
  if (element.attribute("aggregate")) {
    trials.aggregate = static_cast<Aggregate>(read_choice_attribute(element, "aggregate", {"mean", "worst"}));
  }
  if (element.attribute("randomNumbers")) {
    trials.random_numbers =
        static_cast<RandomNumbers>(read_choice_attribute(element, "randomNumbers", {"common", "fresh"}));
  }
  trials.spread.friction = read_spread(element, "friction", spreads);
  trials.spread.mass = read_spread(element, "mass", spreads);
  trials.spread.servo_gain = read_spread(element, "servoGain", spreads);
  trials.spread.latency_ms = read_spread(element, "latency", latencies);
  trials.spread.contact_noise = read_spread(element, "contactNoise", shares);
  return trials;
}

/// Whether the score can be extrapolated: it is a positive multiple of the distance or the speed.
bool can_be_extrapolated(const std::vector<Objective>& objectives) {
  if (objectives.size() != 1 || objectives.front().terms.size() != 1) {
    return false;
  }
  const Objective& objective = objectives.front();
  const Term& term = objective.terms.front();
  return objective.goal == Goal::maximise && term.weight > 0.0 &&
         (term.measure == sim::Measure::distance || term.measure == sim::Measure::speed);
}

Racing read_racing(const XmlElement& element, const std::vector<Objective>& objectives) {
  element.allow({"after", "keep"}, {});
  Racing racing;
  racing.after = read_number_attribute(element, "after", part_runs);
  if (element.attribute("keep")) {
    racing.keep = read_number_attribute(element, "keep", shares);
  }
  if (racing.on() && !can_be_extrapolated(objectives)) {
    element.refuse(element.label() + " with this fitness",
                   "one objective, which is distance or speed with a weight above 0, to be maximised");
  }
  return racing;
}

ConfirmationSettings read_confirmation(const XmlElement& element) {
  element.allow({"candidates", "runs"}, {});
  ConfirmationSettings confirmation;
  if (element.attribute("candidates")) {
    confirmation.candidates = static_cast<std::uint32_t>(read_whole_attribute(element, "candidates", 1, max_trials));
  }
  if (element.attribute("runs")) {
    confirmation.runs = static_cast<std::uint32_t>(read_whole_attribute(element, "runs", 0, max_trials));
  }
  return confirmation;
}

void read_evaluation(const XmlElement& element, Experiment& experiment) {
  element.allow({}, {"evaluations", "seed", "reuse", "trials", "racing", "confirmation"});
  if (const auto evaluations = element.child("evaluations")) {
    experiment.evaluations = read_whole(*evaluations, 0, max_evaluations);
  }
  if (const auto seed = element.child("seed")) {
    experiment.seed = read_whole(*seed, 0, std::numeric_limits<std::uint64_t>::max());
  }
  if (const auto reuse = element.child("reuse")) {
    experiment.reuse = read_whole(*reuse, 0, 1) == 1;
  }
  if (const auto trials = element.child("trials")) {
    experiment.trials = read_trials(*trials);
  }
  if (const auto racing = element.child("racing")) {
    experiment.racing = read_racing(*racing, experiment.objectives);
  }
  if (const auto confirmation = element.child("confirmation")) {
    experiment.confirmation = read_confirmation(*confirmation);
  }
}

void require_trials_to_differ(const XmlElement& evaluation, const Experiment& experiment) {
  const Trials& trials = experiment.trials;
  if (trials.count > 1 && !depends_on_seed(experiment.scenario, experiment.space, trials.spread)) {
    evaluation.required_child("trials").refuse(
        std::to_string(trials.count) + " trials that are all equal",
        "a spread of <friction>, <mass>, <servoGain>, <latency> or <contactNoise>, or noise in the scenario");
  }
}

}  // namespace

std::string Experiment::title() const {
  const std::string name = std::filesystem::path(path).filename().string();
  return name.substr(0, name.find('.'));
}

namespace {

/// read_named: gives the scenario, for the section.
Experiment read(const std::filesystem::path& path, sim::FileSource& files,
                const std::function<sim::Scenario(const XmlElement& section)>& read_named) {
  Experiment experiment;
  experiment.path = path.string();
  experiment.has_baseline = true;
  const std::unique_ptr<sim::XmlDocument> document = sim::SourceSet(files, path, experiment.sources).open_top();
  const XmlElement section = document->root(method_tags);
  constexpr std::array<std::string_view, 1> pagmo_attributes{"algorithm"};
  constexpr std::array<std::string_view, 5> tags{"simulation", "properties", "genome", "fitness", "evaluation"};
  section.allow(std::span(pagmo_attributes).first(section.is("pagmo") ? 1 : 0), tags);

  experiment.scenario = read_named(section);
  experiment.sources.insert(experiment.sources.end(), experiment.scenario.sources.begin(),
                            experiment.scenario.sources.end());
  const XmlElement properties = section.required_child("properties");
  experiment.method_line = properties.line();
  experiment.method = read_method(section, properties, experiment.scenario.remarks);
  experiment.space = read_search_space(properties, section.required_child("genome"), experiment.scenario);
  experiment.objectives = default_objectives();
  if (const auto fitness = section.child("fitness")) {
    constexpr std::array<std::string_view, 1> fitness_attributes{"heading"};
    constexpr std::array<std::string_view, 2> fitness_tags{"objective", "axis"};
    const bool has_map = std::holds_alternative<MapElitesSettings>(experiment.method);
    fitness->allow(fitness_attributes, std::span(fitness_tags).first(has_map ? 2 : 1));
    if (fitness->attribute("heading")) {
      experiment.heading_deg = read_number_attribute(*fitness, "heading", headings);
    }
    experiment.objectives = read_objectives(*fitness);
    read_axes(*fitness, experiment);
  }
  if (const auto evaluation = section.child("evaluation")) {
    read_evaluation(*evaluation, experiment);
    require_trials_to_differ(*evaluation, experiment);
  }
  return experiment;
}

}  // namespace

Experiment read_experiment(const std::filesystem::path& path, sim::FileSource& files,
                           const std::optional<std::filesystem::path>& simulation) {
  return read(path, files,
              [&](const XmlElement& section) { return read_named_scenario(section, path, files, simulation); });
}

Experiment read_experiment(const std::filesystem::path& path, sim::FileSource& files, sim::Scenario scenario) {
  return read(path, files, [&](const XmlElement& /*section*/) { return std::move(scenario); });
}

}  // namespace proleg::optimize
