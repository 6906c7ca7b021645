#include "tools/proleg/robot/assign_dialogue.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"
#include "tools/proleg/common/interrupt.hpp"

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

constexpr const char* which = "Which joint is it? ";

std::string degrees_text(std::int32_t angle) {
  constexpr double tenths = 10.0;
  const double degrees = 90.0 * angle / quarter_turn;
  return number_text(static_cast<double>(static_cast<int>(degrees * tenths + 0.5)) / tenths);
}

/// While a joint moves, its master sends the heartbeats of this host.
class Pause {
 public:
  explicit Pause(HostPresence& presence) : presence_(presence) { presence_.set_active(false); }
  ~Pause() { presence_.set_active(true); }
  Pause(const Pause&) = delete;
  Pause& operator=(const Pause&) = delete;

 private:
  HostPresence& presence_;
};

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

void AssignDialogue::say(const std::string& text) { std::cerr << text << std::flush; }

std::string AssignDialogue::choices() const { return listed(sim::joint_names(robot_)) + ", none, more, quit"; }

std::string AssignDialogue::next_line(MovingJoint* moving) {
  constexpr Microseconds patience = 600'000'000;
  using State = host::JointMotion::State;
  std::optional<std::string> line;
  bus_.wait_for("an answer on standard input", patience, [&] {
    line = line ? line : lines_.next();
    if (moving != nullptr) {
      moving->take_events();
    }
    const bool has_failed = moving != nullptr && moving->motion().state() == State::failed;
    return line || lines_.has_ended() || has_failed;
  });
  if (!line) {
    throw std::runtime_error(lines_.has_ended() || moving == nullptr ? "standard input has ended without an answer"
                                                                     : "the joint stands still: " + moving->problem());
  }
  return std::string(trimmed(*line));
}

AssignDialogue::Answer AssignDialogue::ask_while(
    MovingJoint* moving, const std::function<std::optional<std::string>(unsigned joint)>& why_not) {
  for (;;) {
    say(which);
    const std::string word = next_line(moving);
    if (const auto joint = joint_of(robot_, word)) {
      const auto reason = why_not(*joint);
      if (!reason) {
        return joint;
      }
      say(*reason + ". ");
    } else if (const std::string command = lower_case(word); command == "none") {
      return std::optional<unsigned>();
    } else if (command == "more") {
      return More();
    } else if (command == "quit" || command == "q") {
      throw std::runtime_error("ended by the user");
    } else {
      say(in_quotes(word) + " is none of " + choices() + ". ");
    }
  }
}

std::optional<unsigned> AssignDialogue::ask_for_joint(
    std::uint8_t node, host::JointMotionOptions options,
    const std::function<std::optional<std::string>(unsigned joint)>& why_not) {
  const Pause pause(presence_);
  const std::string name = "Node " + std::to_string(node);
  for (;;) {
    std::optional<MovingJoint> moving;
    try {
      moving.emplace(bus_, node, options);
      say(name + " moves by " + degrees_text(moving->motion().amplitude()) + " degrees. ");
    } catch (const std::runtime_error& error) {
      if (interrupted() || !bus_.connection().state().is_connected) {
        throw;
      }
      say(name + " cannot move (" + error.what() + "). If you know its joint, say it; else none. ");
    }
    const Answer answer = ask_while(moving ? &*moving : nullptr, why_not);
    if (moving) {
      moving->stop();
    }
    if (const auto* joint = std::get_if<std::optional<unsigned>>(&answer)) {
      return *joint;
    }
    options.amplitude = std::min(2 * options.amplitude, largest_amplitude);
  }
}

bool AssignDialogue::ask_to_agree(const std::string& question) {
  for (;;) {
    say(question + " [y/n] ");
    const std::string word = lower_case(next_line(nullptr));
    if (word == "y" || word == "yes") {
      return true;
    }
    if (word == "n" || word == "no") {
      return false;
    }
  }
}

}  // namespace proleg::tools
