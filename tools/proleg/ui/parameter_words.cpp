#include "tools/proleg/ui/parameter_words.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

std::string number_name(const json& parameter) {
  return std::to_string(parameter.at("slot").get<unsigned>()) + '.' + parameter.at("name").get<std::string>();
}

/// Which value of a parameter belongs to a joint.
std::optional<std::size_t> place_of(std::size_t joint, const json& parameter) {
  const auto joints = parameter.at("joints").get<std::vector<std::size_t>>();
  const auto found = std::ranges::find(joints, joint);
  return found == joints.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - joints.begin()));
}

}  // namespace

bool ParameterWords::is_module(const json& slot, const std::string& module) const {
  if (module == std::to_string(slot.get<unsigned>())) {
    return true;
  }
  return std::ranges::any_of(robot_.value("slots", json::array()), [&](const json& known) {
    return known.at("number") == slot && known.at("algorithm") == module;
  });
}

ParameterWords::Parameter ParameterWords::find(const std::string& name, const std::string& where) const {
  const auto refuse = [&](const std::string& found, const std::string& expected) {
    throw InputError(where + shortened(name), 0, found, expected);
  };
  const sim::SettingName parts = sim::parse_setting_name(name);

  std::vector<const json*> meanings;
  std::vector<std::string> known;
  for (const json& parameter : parameters_) {
    if (parameter.at("internal").get<bool>()) {
      continue;
    }
    known.push_back(number_name(parameter));
    if (parameter.at("name") == parts.name && (!parts.module || is_module(parameter.at("slot"), *parts.module))) {
      meanings.push_back(&parameter);
    }
  }
  if (meanings.empty()) {
    refuse("no such parameter", "one of " + listed(known));
  }

  std::size_t place = 0;
  if (parts.joint) {
    const json joints = robot_.value("joints", json::array());
    const auto named =
        std::ranges::find_if(joints, [&](const json& known_joint) { return known_joint.at("name") == *parts.joint; });
    const auto index = static_cast<std::size_t>(named - joints.begin());
    std::erase_if(meanings, [&](const json* parameter) { return !place_of(index, *parameter); });
    if (meanings.empty()) {
      refuse("joint " + in_quotes(*parts.joint), "one that the module drives");
    }
    place = place_of(index, *meanings.front()).value_or(0);
  }
  if (meanings.size() > 1) {
    std::vector<std::string> names;
    names.reserve(meanings.size());
    std::ranges::transform(meanings, std::back_inserter(names),
                           [](const json* meaning) { return number_name(*meaning); });
    refuse("a name in several modules", "one of " + listed(names));
  }
  const json& parameter = *meanings.front();
  const auto scale = parameter.at("scale").get<double>();
  return {parameter.at("minimum").get<double>() * scale, parameter.at("maximum").get<double>() * scale,
          !parameter.at("wraps").get<bool>(), parameter.at("wanted").at(place).get<double>() * scale, scale};
}

void check_binding(const host::Binding& binding, const ParameterWords& words, const std::string& where) {
  const auto* const target = std::get_if<host::ParameterBinding>(&binding.target);
  if (target == nullptr) {
    return;
  }
  for (const std::string& name : target->parameters) {
    const ParameterWords::Parameter parameter = words.find(name, where + ": ");
    const double slack = parameter.resolution / 2;  // the limits themselves are rounded
    for (const double limit : {target->lower, target->upper}) {
      if (parameter.has_limits && (limit < parameter.minimum - slack || limit > parameter.maximum + slack)) {
        throw InputError(where + ": " + shortened(name), 0, "limit " + number_text(limit),
                         number_text(parameter.minimum) + " to " + number_text(parameter.maximum));
      }
    }
  }
}

}  // namespace proleg::tools
