#include "tools/proleg/robot/assign_dialogue.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"
#include "tools/proleg/common/interrupt.hpp"
#include "tools/proleg/robot/joint_words.hpp"

namespace proleg::tools {
namespace {

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
