#include "tools/proleg/ui/experiment_json.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "sim/measure/measure.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;
using optimize::ExperimentForm;

/// A text of the experiment; nothing if it is missing.
std::string member(const json& object, const char* name, std::size_t longest = 1000) {
  const std::string text = argument<std::string>(object, name, "a text").value_or("");
  if (text.size() > longest) {
    throw InputError(name, 0, "a longer text", "at most " + std::to_string(longest) + " characters");
  }
  return text;
}

json object_of(const json& experiment, const char* name) {
  const auto found = experiment.find(name);
  if (found == experiment.end() || found->is_null()) {
    return json();
  }
  if (!found->is_object()) {
    throw InputError(name, 0, shortened(found->dump()), "an object");
  }
  return *found;
}

/// The members of a list, each an object.
std::vector<json> objects_of(const json& experiment, const char* name, std::size_t most) {
  const auto list = argument<std::vector<json>>(experiment, name, "a list").value_or(std::vector<json>());
  if (list.size() > most) {
    throw InputError(name, 0, std::to_string(list.size()), "at most " + std::to_string(most));
  }
  for (const json& object : list) {
    if (!object.is_object()) {
      throw InputError(name, 0, shortened(object.dump()), "an object");
    }
  }
  return list;
}

optimize::ParameterForm parameter_of(const json& object) {
  constexpr std::size_t longest_values = 20'000;
  optimize::ParameterForm parameter;
  parameter.slot = argument<unsigned>(object, "module", "the number of a module").value_or(0);
  parameter.parameter = member(object, "parameter");
  if (const auto joints = argument<std::vector<unsigned>>(object, "joints", "numbers of joints, or null")) {
    JointMask mask;
    for (const unsigned joint : *joints) {
      if (joint >= max_joints) {
        throw InputError("joints", 0, std::to_string(joint), "numbers below " + std::to_string(max_joints));
      }
      mask.insert(joint);
    }
    parameter.joints = mask;
  }
  parameter.is_same = argument<bool>(object, "same", "true or false").value_or(false);
  parameter.lower = member(object, "lower");
  parameter.upper = member(object, "upper");
  parameter.step = member(object, "step");
  parameter.with_lower = argument<bool>(object, "with_lower", "true or false").value_or(true);
  parameter.with_upper = argument<bool>(object, "with_upper", "true or false").value_or(true);
  if (const auto set = object.find("set"); set != object.end() && !set->is_null()) {
    parameter.set = member(object, "set", longest_values);
  }
  return parameter;
}

optimize::ObjectiveForm objective_of(const json& object) {
  constexpr std::size_t most_terms = sim::measure_count;
  optimize::ObjectiveForm objective{member(object, "name"), member(object, "goal"), member(object, "failed"), {}};
  for (const json& term : objects_of(object, "terms", most_terms)) {
    objective.terms.push_back({member(term, "measure"), member(term, "weight")});
  }
  return objective;
}

/// The texts of an object, in the order of these names.
template <std::size_t count>
std::optional<std::array<std::string, count>> texts_of(const json& experiment, const char* name,
                                                       const std::array<const char*, count>& names) {
  const json object = object_of(experiment, name);
  if (object.is_null()) {
    return std::nullopt;
  }
  std::array<std::string, count> texts;
  for (std::size_t i = 0; i < count; ++i) {
    texts[i] = member(object, names[i]);
  }
  return texts;
}

constexpr std::array<const char*, 8> trial_names{"count", "aggregate",  "random_numbers", "friction",
                                                 "mass",  "servo_gain", "latency",        "contact_noise"};
constexpr std::array<const char*, 2> confirmation_names{"candidates", "runs"};
constexpr std::array<const char*, 2> racing_names{"after", "keep"};

json joints_json(const std::optional<JointMask>& joints) {
  if (!joints) {
    return json();
  }
  json list = json::array();
  for (const unsigned joint : *joints) {
    list.push_back(joint);
  }
  return list;
}

json parameter_json(const optimize::ParameterForm& parameter) {
  return {{"module", parameter.slot},
          {"parameter", parameter.parameter},
          {"joints", joints_json(parameter.joints)},
          {"same", parameter.is_same},
          {"lower", parameter.lower},
          {"upper", parameter.upper},
          {"step", parameter.step},
          {"with_lower", parameter.with_lower},
          {"with_upper", parameter.with_upper},
          {"set", parameter.set ? json(*parameter.set) : json()}};
}

json setting_json(const optimize::MethodSetting& setting) {
  using Kind = optimize::MethodSetting::Kind;
  const bool is_choice = setting.kind == Kind::choice;
  return {{"name", setting.tag},
          {"kind", is_choice                     ? "choice"
                   : setting.kind == Kind::whole ? "whole"
                                                 : "number"},
          {"default", setting.usual},
          {"lowest", is_choice ? json() : json(setting.lowest)},
          {"highest", is_choice ? json() : json(setting.highest)},
          {"choices", setting.choices},
          {"help", setting.help}};
}

}  // namespace

ExperimentForm read_experiment_json(const json& experiment) {
  constexpr std::size_t most_parameters = 1000;
  if (!experiment.is_object()) {
    throw InputError("experiment", 0, shortened(experiment.dump()), "an object");
  }
  ExperimentForm form;
  form.method = member(experiment, "method");
  form.algorithm = member(experiment, "algorithm");
  const json settings = object_of(experiment, "settings");
  for (const auto& item : settings.items()) {
    form.settings.emplace(item.key(), member(settings, item.key().c_str()));
  }
  for (const json& parameter : objects_of(experiment, "parameters", most_parameters)) {
    form.parameters.push_back(parameter_of(parameter));
  }
  form.heading = member(experiment, "heading");
  for (const json& objective : objects_of(experiment, "objectives", optimize::max_objectives)) {
    form.objectives.push_back(objective_of(objective));
  }
  for (const json& axis : objects_of(experiment, "axes", optimize::max_map_axes)) {
    form.axes.push_back(
        {member(axis, "measure"), member(axis, "lowest"), member(axis, "highest"), member(axis, "cells")});
  }
  form.evaluations = member(experiment, "evaluations");
  form.seed = member(experiment, "seed");
  form.reuse = argument<bool>(experiment, "reuse", "true or false").value_or(true);
  if (const auto texts = texts_of(experiment, "trials", trial_names)) {
    const auto& [count, aggregate, numbers, friction, mass, gain, latency, noise] = *texts;
    form.trials = optimize::TrialsForm{count, aggregate, numbers, friction, mass, gain, latency, noise};
  }
  if (const auto texts = texts_of(experiment, "confirmation", confirmation_names)) {
    form.confirmation = optimize::ConfirmationForm{(*texts)[0], (*texts)[1]};
  }
  if (const auto texts = texts_of(experiment, "racing", racing_names)) {
    form.racing = optimize::RacingForm{(*texts)[0], (*texts)[1]};
  }
  return form;
}

json experiment_json(const ExperimentForm& form) {
  json parameters = json::array();
  for (const optimize::ParameterForm& parameter : form.parameters) {
    parameters.push_back(parameter_json(parameter));
  }
  json objectives = json::array();
  for (const optimize::ObjectiveForm& objective : form.objectives) {
    json terms = json::array();
    for (const optimize::TermForm& term : objective.terms) {
      terms.push_back({{"measure", term.measure}, {"weight", term.weight}});
    }
    objectives.push_back({{"name", objective.name},
                          {"goal", objective.goal},
                          {"failed", objective.failed},
                          {"terms", std::move(terms)}});
  }
  json axes = json::array();
  for (const optimize::AxisForm& axis : form.axes) {
    axes.push_back(
        {{"measure", axis.measure}, {"lowest", axis.lowest}, {"highest", axis.highest}, {"cells", axis.cells}});
  }
  json trials;
  if (form.trials) {
    const optimize::TrialsForm& its = *form.trials;
    trials = {{"count", its.count},
              {"aggregate", its.aggregate},
              {"random_numbers", its.random_numbers},
              {"friction", its.friction},
              {"mass", its.mass},
              {"servo_gain", its.servo_gain},
              {"latency", its.latency},
              {"contact_noise", its.contact_noise}};
  }
  json confirmation;
  if (form.confirmation) {
    confirmation = {{"candidates", form.confirmation->candidates}, {"runs", form.confirmation->runs}};
  }
  json racing;
  if (form.racing) {
    racing = {{"after", form.racing->after}, {"keep", form.racing->keep}};
  }
  return {{"method", form.method},
          {"algorithm", form.algorithm},
          {"settings", form.settings},
          {"parameters", std::move(parameters)},
          {"objectives", std::move(objectives)},
          {"axes", std::move(axes)},
          {"heading", form.heading},
          {"evaluations", form.evaluations},
          {"seed", form.seed},
          {"reuse", form.reuse},
          {"trials", std::move(trials)},
          {"confirmation", std::move(confirmation)},
          {"racing", std::move(racing)}};
}

json search_methods_json() {
  json methods = json::array();
  for (const optimize::MethodDeclaration& method : optimize::methods()) {
    json settings = json::array();
    for (const optimize::MethodSetting& setting : method.settings) {
      settings.push_back(setting_json(setting));
    }
    const char* const objectives = method.objectives == optimize::ObjectiveCount::one       ? "one"
                                   : method.objectives == optimize::ObjectiveCount::several ? "several"
                                                                                            : "any";
    methods.push_back({{"tag", method.tag},
                       {"algorithm", text_or_null(std::string(method.algorithm))},
                       {"title", method.title},
                       {"help", method.help},
                       {"objectives", objectives},
                       {"has_map", method.has_map},
                       {"settings", std::move(settings)}});
  }
  json measures = json::array();
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    measures.push_back({{"name", measure.name},
                        {"unit", measure.unit},
                        {"help", measure.help},
                        {"higher_is_better", measure.higher_is_better},
                        {"may_be_negative", measure.may_be_negative}});
  }
  return {{"methods", std::move(methods)},
          {"measures", std::move(measures)},
          {"most_objectives", optimize::max_objectives},
          {"most_axes", optimize::max_map_axes}};
}

}  // namespace proleg::tools
