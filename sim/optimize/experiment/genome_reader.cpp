#include "sim/optimize/experiment/section_readers.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/value_set.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::optimize {
namespace {

using sim::XmlElement;

constexpr std::size_t max_dimensions = 1000;
constexpr std::size_t max_values_in_all = 10'000'000;

/// A <parameter> of <registeredParameters>: a parameter of the actuation module in a slot.
struct Registration {
  XmlElement element;
  unsigned slot;
  unsigned index;
};

unsigned read_slot(const XmlElement& element, const sim::Scenario& scenario) {
  const std::string module = element.required_attribute("controlAlgorithm");
  const std::vector<unsigned> slots = find_slots(scenario, module);
  if (slots.empty()) {
    element.refuse("unknown module " + in_quotes(module), "one of " + listed(slot_names(scenario)));
  }
  if (slots.size() > 1) {
    element.refuse("several modules " + in_quotes(module), "the number of one of " + listed(slot_names(scenario)));
  }
  if (scenario.kernel.slots[slots.front()].group.empty()) {
    element.refuse("module " + in_quotes(module) + ", which drives no joint", "one that does");
  }
  return slots.front();
}

Registration read_registration(const XmlElement& element, const sim::Scenario& scenario) {
  const unsigned slot = read_slot(element, scenario);
  const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
  const std::string name = element.required_attribute("parameter");
  const int index = sim::find_named_parameter(declaration, name);
  if (index < 0) {
    element.refuse("unknown parameter " + in_quotes(name) + " of " + std::string(declaration.name),
                   "one of " + listed(sim::parameter_names(declaration)));
  }
  return {element, slot, static_cast<unsigned>(index)};
}

/// The number that connects a <parameter> with its <genomeConfig>.
unsigned read_parameter_number(const XmlElement& element) {
  return static_cast<unsigned>(read_whole_attribute(element, "number", 0, max_dimensions - 1));
}

std::map<unsigned, Registration> read_registrations(const XmlElement& properties, const sim::Scenario& scenario) {
  const XmlElement list = properties.required_child("registeredParameters");
  list.allow({}, {"parameter"});
  std::map<unsigned, Registration> registrations;
  for (const XmlElement& element : list.children()) {
    element.allow({"number", "controlAlgorithm", "parameter"}, {});
    const unsigned number = read_parameter_number(element);
    if (const auto other = registrations.find(number); other != registrations.end()) {
      element.refuse("a second parameter with number " + std::to_string(number),
                     "another number; the first is in line " + std::to_string(other->second.element.line()));
    }
    registrations.emplace(number, read_registration(element, scenario));
  }
  if (registrations.empty()) {
    list.refuse("no <parameter> in " + list.label(), "at least one");
  }
  if (registrations.rbegin()->first != registrations.size() - 1) {
    unsigned missing = 0;
    while (registrations.contains(missing)) {
      ++missing;
    }
    list.refuse("no parameter with number " + std::to_string(missing),
                "numbers from 0 to " + std::to_string(registrations.size() - 1));
  }
  if (const auto count = properties.child("numOfParametersToOptimize")) {
    if (read_whole(*count, 0, max_dimensions) != registrations.size()) {
      count->refuse(in_quotes(count->text()) + " in " + count->label(),
                    std::to_string(registrations.size()) + ", as many as are registered");
    }
  }
  return registrations;
}

/// Turns <genomeConfig>s into dimensions.
class SpaceBuilder {
 public:
  explicit SpaceBuilder(const sim::Scenario& scenario) : scenario_(&scenario) {}

  void add(const XmlElement& config, const Registration& registration) {
    config.allow(
        {"number", "allJoints", "genomeType", "valueType", "valueSpace", "activeJoints"},
        {"upperBounds", "lowerBounds", "boundsIncrements", "lowerBoundTypes", "upperBoundTypes", "uniform", "values"});
    check_types(config);
    const Slot& slot = scenario_->kernel.slots[registration.slot];
    const Parameter& parameter = slot.algorithm->declaration().parameters[registration.index];
    const std::vector<unsigned> joints = read_joints(config, registration);
    for (const unsigned joint : joints) {
      claim_parameter(config, registration, parameter, joint);
    }
    const bool uniform = read_whole(config.required_child("uniform"), 0, 1) == 1;
    if (uniform) {
      add_dimension(config, registration, parameter, joints, read_values(config, parameter, 1)(0));
      return;
    }
    // Bounds of single joints are in the order of the robot file, dimensions from head to tail.
    const ValuesOfJoint values = read_values(config, parameter, joints.size());
    std::vector<std::pair<unsigned, std::size_t>> from_head;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      from_head.emplace_back(joints[i], i);
    }
    std::ranges::sort(from_head);
    for (const auto& [joint, i] : from_head) {
      add_dimension(config, registration, parameter, {joint}, values(i));
    }
  }

  [[nodiscard]] SearchSpace release_space() { return std::move(space_); }

 private:
  /// Checks settings of the thesis's program. Its files show one value of each, and the text does not explain them.
  static void check_types(const XmlElement& config) {
    for (const std::string_view name : {"genomeType", "valueType"}) {
      if (const auto type = config.attribute(name); type && *type != "1") {
        config.refuse(std::string(name) + " " + in_quotes(*type) + " in " + config.label(),
                      "'1', the only known value");
      }
    }
  }

  /// The joints whose parameter is searched for, in the order of the robot file.
  [[nodiscard]] std::vector<unsigned> read_joints(const XmlElement& config, const Registration& registration) const {
    const std::vector<sim::Joint>& joints = scenario_->robot.joints;
    const JointMask driven = scenario_->kernel.slots[registration.slot].group;
    const bool all = !config.attribute("allJoints") || read_whole_attribute(config, "allJoints", 0, 1) == 1;
    const std::optional<std::string> mask =
        all ? config.attribute("activeJoints") : config.required_attribute("activeJoints");
    if (mask && (mask->size() != joints.size() || mask->find_first_not_of("01") != std::string::npos)) {
      config.refuse("activeJoints " + in_quotes(*mask), std::to_string(joints.size()) +
                                                            " characters 0 or 1, one for each joint in the order of "
                                                            "the robot file");
    }
    std::vector<unsigned> in_file_order(joints.size());
    for (unsigned j = 0; j < joints.size(); ++j) {
      in_file_order[joints[j].file_index] = j;
    }
    std::vector<unsigned> chosen;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const unsigned joint = in_file_order[i];
      if (all ? driven.contains(joint) : (*mask)[i] == '1') {
        chosen.push_back(joint);
      }
    }
    if (chosen.empty()) {
      config.refuse("no joint marked in activeJoints " + in_quotes(*mask), "at least one 1, or allJoints=\"1\"");
    }
    for (const unsigned joint : chosen) {
      if (!driven.contains(joint)) {
        config.refuse("joint " + in_quotes(joints[joint].name) + " in activeJoints, which " +
                          slot_name(*scenario_, registration.slot) + " does not drive",
                      "some of " + listed(joint_names(scenario_->robot, driven)));
      }
    }
    return chosen;
  }

  /// Records that a dimension sets this parameter of the joint; only one may.
  void claim_parameter(const XmlElement& config, const Registration& registration, const Parameter& parameter,
                       unsigned joint) {
    const auto [other, is_new] =
        claimed_.emplace(std::tuple(registration.slot, joint, registration.index), config.line());
    if (!is_new) {
      config.refuse("parameter " + in_quotes(parameter.name) + " of joint " +
                        in_quotes(scenario_->robot.joints[joint].name) + " a second time",
                    "it once; the first is in line " + std::to_string(other->second));
    }
  }

  /// Name as in `--set`: "amplitude", "amplitude:J5", with "1." in front if another module of these joints has the name
  /// too.
  [[nodiscard]] std::string name_of(const Registration& registration, const Parameter& parameter,
                                    const std::vector<unsigned>& joints) const {
    JointMask mask;
    for (const unsigned joint : joints) {
      mask.insert(joint);
    }
    const auto& slots = scenario_->kernel.slots;
    // A single joint is always named: another dimension may set the next one.
    const bool all = joints.size() > 1 && mask == slots[registration.slot].group;
    bool ambiguous = false;
    for (unsigned slot = 0; slot < max_slots; ++slot) {
      const bool has_it = slot != registration.slot && slots[slot].algorithm != nullptr &&
                          find_parameter(slots[slot].algorithm->declaration(), parameter.name) >= 0;
      ambiguous = ambiguous || (has_it && (all || (slots[slot].group.bits() & mask.bits()) != 0));
    }
    std::string name = ambiguous ? std::to_string(registration.slot + 1) + "." : std::string();
    name += parameter.name;
    if (!all) {
      std::string separator = ":";
      for (const std::string& joint : joint_names(scenario_->robot, mask)) {
        name += separator + joint;
        separator = ",";
      }
    }
    return name;
  }

  void add_dimension(const XmlElement& config, const Registration& registration, const Parameter& parameter,
                     std::vector<unsigned> joints, std::vector<std::int32_t> values) {
    value_count_ += values.size();
    if (space_.dimensions.size() == max_dimensions || value_count_ > max_values_in_all) {
      config.refuse("more than " + std::to_string(max_dimensions) + " dimensions or " +
                        std::to_string(max_values_in_all) + " values in all",
                    "at most that");
    }
    Dimension dimension;
    dimension.name = name_of(registration, parameter, joints);
    if (!names_.insert(dimension.name).second) {
      config.refuse("a second dimension " + in_quotes(dimension.name), "joints with other names");
    }
    dimension.unit = parameter.unit;
    dimension.values = std::move(values);
    std::ranges::sort(joints);
    for (const unsigned joint : joints) {
      Setting target;
      target.slot = static_cast<std::uint8_t>(registration.slot);
      target.joint = static_cast<std::uint8_t>(joint);
      target.number = static_cast<std::uint8_t>(registration.index);
      dimension.targets.push_back(target);
    }
    space_.dimensions.push_back(std::move(dimension));
  }

  const sim::Scenario* scenario_;
  SearchSpace space_;
  std::map<std::tuple<unsigned, unsigned, unsigned>, int> claimed_;  ///< line of each slot, joint and parameter
  std::set<std::string> names_;
  std::size_t value_count_ = 0;
};

}  // namespace

SearchSpace read_search_space(const XmlElement& properties, const XmlElement& genome, const sim::Scenario& scenario) {
  const std::map<unsigned, Registration> registrations = read_registrations(properties, scenario);
  genome.allow({}, {"genomeConfig"});
  std::map<unsigned, XmlElement> configs;
  for (const XmlElement& config : genome.children()) {
    const unsigned number = read_parameter_number(config);
    if (!registrations.contains(number)) {
      config.refuse("number " + std::to_string(number) + " in " + config.label(),
                    "that of a registered parameter, 0 to " + std::to_string(registrations.size() - 1));
    }
    if (const auto [other, is_new] = configs.emplace(number, config); !is_new) {
      config.refuse("a second " + config.label() + " with number " + std::to_string(number),
                    "another number; the first is in line " + std::to_string(other->second.line()));
    }
  }
  SpaceBuilder builder(scenario);
  for (const auto& [number, registration] : registrations) {
    const auto config = configs.find(number);
    if (config == configs.end()) {
      registration.element.refuse("no <genomeConfig> with number " + std::to_string(number), "one");
    }
    builder.add(config->second, registration);
  }
  return builder.release_space();
}

}  // namespace proleg::optimize
