#include "sim/optimize/experiment/experiment_form.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {
namespace {

using sim::XmlElement;

using Attributes = std::vector<std::pair<std::string_view, std::string>>;

/// The lines of a file, each with the field that it shows.
class Lines {
 public:
  /// An element with other elements inside; the end of the returned object closes it.
  class Block {
   public:
    Block(Lines& lines, std::string_view tag) : lines_(lines), tag_(tag) {}
    ~Block() {
      --lines_.depth_;
      lines_.add("</" + std::string(tag_) + ">", "");
    }
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;

   private:
    Lines& lines_;
    std::string_view tag_;
  };

  [[nodiscard]] Block block(std::string_view tag, const std::string& field = {}, const Attributes& attributes = {}) {
    add("<" + opening(tag, attributes) + ">", field);
    ++depth_;
    return {*this, tag};
  }
  void element(std::string_view tag, const std::string& field, const Attributes& attributes) {
    add("<" + opening(tag, attributes) + "/>", field);
  }
  void text(std::string_view tag, const std::string& content, const std::string& field,
            const Attributes& attributes = {}) {
    add("<" + opening(tag, attributes) + ">" + written(content) + "</" + std::string(tag) + ">", field);
  }
  /// Nothing for an empty text: the default holds.
  void text_if_any(std::string_view tag, const std::string& content, const std::string& field,
                   const Attributes& attributes = {}) {
    if (!trimmed(content).empty()) {
      text(tag, content, field, attributes);
    }
  }

  [[nodiscard]] ExperimentText take() { return std::move(made_); }

 private:
  /// In one line, so that each field has one.
  static std::string written(const std::string& text) { return escaped_xml(one_line(text)); }
  static std::string opening(std::string_view tag, const Attributes& attributes) {
    std::string words(tag);
    for (const auto& [name, value] : attributes) {
      words += " " + std::string(name) + "=\"" + written(value) + "\"";
    }
    return words;
  }
  void add(const std::string& line, const std::string& field) {
    made_.text += std::string(2 * depth_, ' ') + line + '\n';
    made_.fields.push_back(field);
  }

  ExperimentText made_;
  std::size_t depth_ = 0;
};

/// Adds attributes that are not empty.
void add_if_any(Attributes& attributes, std::string_view name, const std::string& value) {
  if (!trimmed(value).empty()) {
    attributes.emplace_back(name, value);
  }
}

/// How a file names an actuation module: by its algorithm, if that is enough.
std::string module_text(const sim::Scenario& scenario, unsigned slot) {
  const std::vector<unsigned> used = sim::used_slots(scenario);
  if (std::ranges::find(used, slot) == used.end()) {
    throw InputError("module", 0, std::to_string(slot), "one of the " + std::to_string(used.size()) + " modules");
  }
  const std::string name(scenario.kernel.slots[slot].algorithm->declaration().name);
  return sim::find_slots(scenario, name).size() == 1 ? name : std::to_string(slot + 1);
}

/// One character for each joint, in the order of the robot's file.
std::string mask_text(const sim::Scenario& scenario, JointMask joints) {
  std::string mask(scenario.robot.joints.size(), '0');
  for (unsigned joint = 0; joint < scenario.robot.joints.size(); ++joint) {
    if (joints.contains(joint)) {
      mask[scenario.robot.joints[joint].file_index] = '1';
    }
  }
  return mask;
}

void write_parameter(const ParameterForm& parameter, const sim::Scenario& scenario, std::size_t number, Lines& lines) {
  const std::string field = "parameters." + std::to_string(number);
  Attributes attributes{{"number", std::to_string(number)},
                        {"allJoints", parameter.joints ? "0" : "1"},
                        {"genomeType", "1"},
                        {"valueType", "1"},
                        {"valueSpace", parameter.set ? "0" : "1"}};
  if (parameter.joints) {
    attributes.emplace_back("activeJoints", mask_text(scenario, *parameter.joints));
  }
  const Lines::Block config = lines.block("genomeConfig", field + ".joints", attributes);
  if (parameter.set) {
    lines.text("values", *parameter.set, field + ".set");
  } else {
    lines.text("lowerBounds", parameter.lower, field + ".lower");
    lines.text("upperBounds", parameter.upper, field + ".upper");
    lines.text("boundsIncrements", parameter.step, field + ".step");
    lines.text("lowerBoundTypes", parameter.with_lower ? "1" : "2", field + ".lower");
    lines.text("upperBoundTypes", parameter.with_upper ? "1" : "2", field + ".upper");
  }
  lines.text("uniform", parameter.is_same ? "1" : "0", field + ".same");
}

void write_properties(const ExperimentForm& form, const sim::Scenario& scenario, Lines& lines) {
  const Lines::Block properties = lines.block("properties", "method");
  for (const auto& [tag, value] : form.settings) {
    const bool is_name = std::ranges::all_of(
        tag, [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); });
    if (tag.empty() || !is_name) {
      throw InputError("settings", 0, in_quotes(tag), "the name of a setting");
    }
    lines.text_if_any(tag, value, "settings." + tag);
  }
  const Lines::Block registered = lines.block("registeredParameters", "parameters");
  for (std::size_t i = 0; i < form.parameters.size(); ++i) {
    const ParameterForm& its = form.parameters[i];
    lines.element("parameter", "parameters." + std::to_string(i) + ".parameter",
                  {{"number", std::to_string(i)},
                   {"controlAlgorithm", module_text(scenario, its.slot)},
                   {"parameter", its.parameter}});
  }
}

/// The axes of a form whose method was changed to one without a map are kept, and not written.
bool has_map(const ExperimentForm& form) {
  const auto its = std::ranges::find(methods(), form.method, &MethodDeclaration::tag);
  return its != methods().end() && its->has_map;
}

void write_objectives(const ExperimentForm& form, Lines& lines) {
  const std::size_t axes = has_map(form) ? form.axes.size() : 0;
  if (form.objectives.empty() && axes == 0 && trimmed(form.heading).empty()) {
    return;
  }
  Attributes heading;
  add_if_any(heading, "heading", form.heading);
  const Lines::Block fitness = lines.block("fitness", "heading", heading);
  if (form.objectives.empty()) {
    lines.element("objective", "objectives", {{"measure", "distance"}});
  }
  for (std::size_t i = 0; i < form.objectives.size(); ++i) {
    const ObjectiveForm& its = form.objectives[i];
    const std::string field = "objectives." + std::to_string(i);
    Attributes attributes;
    add_if_any(attributes, "name", its.name);
    add_if_any(attributes, "goal", its.goal);
    add_if_any(attributes, "failed", its.failed);
    if (its.terms.size() == 1 && trimmed(its.terms.front().weight).empty()) {
      attributes.emplace_back("measure", its.terms.front().measure);
      lines.element("objective", field, attributes);
      continue;
    }
    const Lines::Block objective = lines.block("objective", field, attributes);
    for (std::size_t k = 0; k < its.terms.size(); ++k) {
      Attributes term{{"measure", its.terms[k].measure}};
      add_if_any(term, "weight", its.terms[k].weight);
      lines.element("term", field + ".terms." + std::to_string(k), term);
    }
  }
  for (std::size_t i = 0; i < axes; ++i) {
    const AxisForm& its = form.axes[i];
    Attributes axis{{"measure", its.measure}, {"lowest", its.lowest}, {"highest", its.highest}};
    add_if_any(axis, "cells", its.cells);
    lines.element("axis", "axes." + std::to_string(i), axis);
  }
}

void write_trials(const TrialsForm& trials, Lines& lines) {
  Attributes attributes;
  add_if_any(attributes, "count", trials.count);
  add_if_any(attributes, "aggregate", trials.aggregate);
  add_if_any(attributes, "randomNumbers", trials.random_numbers);
  const Lines::Block block = lines.block("trials", "trials.count", attributes);
  lines.text_if_any("friction", trials.friction, "trials.friction");
  lines.text_if_any("mass", trials.mass, "trials.mass");
  lines.text_if_any("servoGain", trials.servo_gain, "trials.servo_gain");
  lines.text_if_any("latency", trials.latency, "trials.latency", {{"unit", "ms"}});
  lines.text_if_any("contactNoise", trials.contact_noise, "trials.contact_noise");
}

void write_evaluation(const ExperimentForm& form, Lines& lines) {
  const Lines::Block evaluation = lines.block("evaluation");
  lines.text_if_any("evaluations", form.evaluations, "evaluations");
  lines.text_if_any("seed", form.seed, "seed");
  if (!form.reuse) {
    lines.text("reuse", "0", "reuse");
  }
  if (form.trials) {
    write_trials(*form.trials, lines);
  }
  if (form.confirmation) {
    Attributes attributes;
    add_if_any(attributes, "candidates", form.confirmation->candidates);
    add_if_any(attributes, "runs", form.confirmation->runs);
    lines.element("confirmation", "confirmation", attributes);
  }
  if (form.racing) {
    Attributes attributes;
    add_if_any(attributes, "after", form.racing->after);
    add_if_any(attributes, "keep", form.racing->keep);
    lines.element("racing", "racing", attributes);
  }
}

/// The text of a child, or nothing.
std::string text_of(const XmlElement& element, std::string_view tag,
                    std::initializer_list<std::string_view> attributes = {}) {
  const auto child = element.child(tag);
  return child ? child->text(attributes) : std::string();
}

ParameterForm parameter_form(const XmlElement& registration, const XmlElement& config, const sim::Scenario& scenario) {
  const std::string module = registration.required_attribute("controlAlgorithm");
  const std::vector<unsigned> slots = sim::find_slots(scenario, module);
  if (slots.size() != 1) {
    registration.refuse("module " + in_quotes(module), "one of " + listed(sim::slot_names(scenario)));
  }
  ParameterForm form;
  form.slot = slots.front();
  const Declaration& declaration = scenario.kernel.slots[form.slot].algorithm->declaration();
  const std::string name = registration.required_attribute("parameter");
  const int parameter = sim::find_named_parameter(declaration, name);
  form.parameter = parameter < 0 ? name : std::string(declaration.parameters[static_cast<unsigned>(parameter)].name);
  if (config.attribute("allJoints").value_or("1") != "1") {
    const std::string mask = config.required_attribute("activeJoints");
    if (mask.size() != scenario.robot.joints.size()) {
      config.refuse("activeJoints " + in_quotes(mask), std::to_string(scenario.robot.joints.size()) + " characters");
    }
    JointMask joints;
    for (unsigned joint = 0; joint < scenario.robot.joints.size(); ++joint) {
      if (mask[scenario.robot.joints[joint].file_index] == '1') {
        joints.insert(joint);
      }
    }
    form.joints = joints;
  }
  form.is_same = text_of(config, "uniform") == "1";
  if (config.attribute("valueSpace").value_or("1") == "0") {
    form.set = text_of(config, "values");
    return form;
  }
  form.lower = text_of(config, "lowerBounds");
  form.upper = text_of(config, "upperBounds");
  form.step = text_of(config, "boundsIncrements");
  // One word, or the same one for each joint: the form has one for all.
  const auto is_included = [&](std::string_view tag) {
    const std::string text = text_of(config, tag);
    return words(text).empty() || words(text).front() != "2";
  };
  form.with_lower = is_included("lowerBoundTypes");
  form.with_upper = is_included("upperBoundTypes");
  return form;
}

std::vector<ParameterForm> parameter_forms(const XmlElement& properties, const XmlElement& genome,
                                           const sim::Scenario& scenario) {
  std::vector<std::pair<std::string, XmlElement>> configs;
  for (const XmlElement& config : genome.children()) {
    configs.emplace_back(config.required_attribute("number"), config);
  }
  std::vector<ParameterForm> parameters;
  for (const XmlElement& registration : properties.required_child("registeredParameters").children()) {
    const std::string number = registration.required_attribute("number");
    const auto config = std::ranges::find(configs, number, &std::pair<std::string, XmlElement>::first);
    if (config == configs.end()) {
      registration.refuse("no <genomeConfig> with number " + in_quotes(number), "one");
    }
    parameters.push_back(parameter_form(registration, config->second, scenario));
  }
  return parameters;
}

std::vector<ObjectiveForm> objective_forms(const XmlElement& fitness) {
  std::vector<ObjectiveForm> objectives;
  for (const XmlElement& element : fitness.children()) {
    if (element.is("axis")) {
      continue;
    }
    ObjectiveForm objective;
    objective.name = element.attribute("name").value_or("");
    objective.goal = element.attribute("goal").value_or("");
    objective.failed = element.attribute("failed").value_or("");
    if (const auto measure = element.attribute("measure")) {
      objective.terms.push_back({*measure, ""});
    }
    for (const XmlElement& term : element.children()) {
      objective.terms.push_back({term.required_attribute("measure"), term.attribute("weight").value_or("")});
    }
    objectives.push_back(std::move(objective));
  }
  return objectives;
}

std::vector<AxisForm> axis_forms(const XmlElement& fitness) {
  std::vector<AxisForm> axes;
  for (const XmlElement& element : fitness.children()) {
    if (element.is("axis")) {
      const auto attribute = [&](const char* name) { return element.attribute(name).value_or(""); };
      axes.push_back({attribute("measure"), attribute("lowest"), attribute("highest"), attribute("cells")});
    }
  }
  return axes;
}

void add_runs(const XmlElement& evaluation, ExperimentForm& form) {
  form.evaluations = text_of(evaluation, "evaluations");
  form.seed = text_of(evaluation, "seed");
  form.reuse = text_of(evaluation, "reuse") != "0";
  if (const auto trials = evaluation.child("trials")) {
    form.trials = TrialsForm{trials->attribute("count").value_or(""),
                             trials->attribute("aggregate").value_or(""),
                             trials->attribute("randomNumbers").value_or(""),
                             text_of(*trials, "friction", {"unit"}),
                             text_of(*trials, "mass", {"unit"}),
                             text_of(*trials, "servoGain", {"unit"}),
                             text_of(*trials, "latency", {"unit"}),
                             text_of(*trials, "contactNoise", {"unit"})};
  }
  if (const auto its = evaluation.child("confirmation")) {
    form.confirmation =
        ConfirmationForm{its->attribute("candidates").value_or(""), its->attribute("runs").value_or("")};
  }
  if (const auto racing = evaluation.child("racing")) {
    form.racing = RacingForm{racing->attribute("after").value_or(""), racing->attribute("keep").value_or("")};
  }
}

}  // namespace

ExperimentText experiment_text(const ExperimentForm& form, const sim::Scenario& scenario,
                               const std::string& simulation) {
  const auto* const tag = std::ranges::find(method_tags, form.method);
  if (tag == method_tags.end()) {
    throw InputError("method", 0, in_quotes(form.method), "the tag of a method");
  }
  Lines lines;
  {
    Attributes attributes;
    if (*tag == "pagmo") {
      attributes.emplace_back("algorithm", form.algorithm);
    }
    const Lines::Block section = lines.block(*tag, "method", attributes);
    lines.text("simulation", simulation, "");
    write_properties(form, scenario, lines);
    {
      const Lines::Block genome = lines.block("genome", "parameters");
      for (std::size_t i = 0; i < form.parameters.size(); ++i) {
        write_parameter(form.parameters[i], scenario, i, lines);
      }
    }
    write_objectives(form, lines);
    write_evaluation(form, lines);
  }
  return lines.take();
}

ExperimentForm read_experiment_form(const std::filesystem::path& path, sim::FileSource& files,
                                    const sim::Scenario& scenario) {
  std::vector<sim::SourceFile> record;
  const std::unique_ptr<sim::XmlDocument> document = sim::SourceSet(files, path, record).open_top();
  const XmlElement section = document->root(method_tags);
  ExperimentForm form;
  form.method = *std::ranges::find_if(method_tags, [&](std::string_view tag) { return section.is(tag); });
  form.algorithm = section.attribute("algorithm").value_or("");
  const XmlElement properties = section.required_child("properties");
  for (const MethodDeclaration& method : methods()) {
    if (method.tag == form.method && (method.tag != "pagmo" || method.algorithm == form.algorithm)) {
      for (const MethodSetting& setting : method.settings) {
        if (const auto element = properties.child(setting.tag)) {
          form.settings.emplace(setting.tag, element->text());
        }
      }
    }
  }
  form.parameters = parameter_forms(properties, section.required_child("genome"), scenario);
  if (const auto fitness = section.child("fitness")) {
    form.heading = fitness->attribute("heading").value_or("");
    form.objectives = objective_forms(*fitness);
    form.axes = axis_forms(*fitness);
  }
  if (const auto evaluation = section.child("evaluation")) {
    add_runs(*evaluation, form);
  }
  return form;
}

}  // namespace proleg::optimize
