#include "sim/optimize/experiment/fitness_reader.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::optimize {
namespace {

using sim::XmlElement;

constexpr std::size_t max_objectives = 8;
constexpr sim::Range weights{-1e9, 1e9, ""};
constexpr sim::Range scores{-1e12, 1e12, ""};
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
  objective.failed = element.attribute("failed") ? read_number_attribute(element, "failed", scores)
                                                 : natural_failed(element, objective);
  return objective;
}

}  // namespace

std::vector<Objective> read_objectives(const XmlElement& fitness) {
  std::vector<Objective> objectives;
  for (const XmlElement& child : fitness.children()) {
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

std::vector<Objective> default_objectives() {
  Objective distance;
  distance.name = declaration_of(sim::Measure::distance).name;
  distance.terms.push_back({sim::Measure::distance, 1.0});
  return {distance};
}

}  // namespace proleg::optimize
