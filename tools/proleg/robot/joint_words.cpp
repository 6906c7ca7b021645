#include "tools/proleg/robot/joint_words.hpp"

#include <algorithm>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"

namespace proleg::tools {
namespace {

/// The digits at the end of a name.
std::string_view number_of(std::string_view name) { return name.substr(name.find_last_not_of("0123456789") + 1); }

template <typename IsMeant>
std::optional<unsigned> only_joint(const sim::RobotModel& robot, IsMeant&& is_meant) {
  std::optional<unsigned> found;
  for (unsigned joint = 0; joint < robot.joints.size(); ++joint) {
    if (is_meant(robot.joints[joint].name)) {
      if (found) {
        return std::nullopt;
      }
      found = joint;
    }
  }
  return found;
}

}  // namespace

std::optional<unsigned> joint_of(const sim::RobotModel& robot, std::string_view word) {
  if (word.empty()) {
    return std::nullopt;
  }
  if (const auto same = only_joint(robot, [&](const std::string& name) { return name == word; })) {
    return same;
  }
  const std::string lower = lower_case(word);
  if (const auto similar = only_joint(robot, [&](const std::string& name) { return lower_case(name) == lower; })) {
    return similar;
  }
  return only_joint(robot, [&](const std::string& name) { return number_of(name) == word; });
}

std::vector<Place> parse_places(const sim::RobotModel& robot, std::string_view words) {
  std::vector<Place> places;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    const std::string_view word = trimmed(words.substr(begin, end - begin));
    begin = end + 1;
    const std::size_t equals = std::min(word.find('='), word.size());
    const auto node = parse_whole<std::uint8_t>(word.substr(0, equals));
    const auto joint = equals < word.size() ? joint_of(robot, word.substr(equals + 1)) : std::nullopt;
    if (!node || !joint) {
      throw InputError("--places", 0, in_quotes(word),
                       "NODE=JOINT, such as 3=J1; the joints are " + listed(sim::joint_names(robot)));
    }
    for (const Place& other : places) {
      if (other.node == *node || other.joint == *joint) {
        throw InputError(
            "--places", 0,
            in_quotes(word) + " after node " + std::to_string(other.node) + " for " + robot.joints[other.joint].name,
            "each module and each joint once");
      }
    }
    places.push_back({*node, *joint});
  }
  return places;
}

}  // namespace proleg::tools
