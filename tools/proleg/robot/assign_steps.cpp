#include "tools/proleg/robot/assign_steps.hpp"

#include <algorithm>
#include <bitset>
#include <exception>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/master/master_report.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

constexpr Microseconds second = 1'000'000;

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

void reset_all(BusAccess& bus) {
  /// Who boots. Two modules with one node id boot, report it once, and stop.
  class BootWatch final : public host::BusUser {
   public:
    void receive(Microseconds /*now*/, const CanFrame& frame) override {
      if (const auto heartbeat = canopen::decode_heartbeat(frame);
          heartbeat && heartbeat->state == canopen::NmtState::boot_up) {
        duplicate = boots.test(heartbeat->node) ? heartbeat->node : duplicate;
        boots.set(heartbeat->node);
      } else if (const auto emergency = canopen::decode_emergency(frame);
                 emergency && emergency->code == canopen::EmergencyCode::identifier_collision) {
        duplicate = emergency->node;
      }
    }
    std::bitset<128> boots;
    std::uint8_t duplicate = 0;
  };
  constexpr Microseconds boot_time = 400'000;
  bus.wait_for("room for a frame", second, [&bus] {
    return bus.connection().send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, 0}));
  });
  BootWatch watch;
  const host::BusAttachment attachment(bus.connection(), watch);
  bus.connection().run_for(boot_time);
  if (watch.duplicate != 0) {
    throw std::runtime_error("two modules have the node id " + std::to_string(watch.duplicate) +
                             ", and have stopped; run 'proleg recover', which gives one of them another node id, then "
                             "proleg assign again");
  }
}

ModulesToNumber find_modules_to_number(BusAccess& bus) {
  host::BusScan all(bus.connection());
  scan(bus, all);
  ModulesToNumber found;
  for (const host::ScannedNode& node : all.nodes()) {
    if (!node.is_module) {
      found.others.push_back(node.node);
      continue;
    }
    const canopen::LssAddress address{node.vendor, node.product, node.revision, node.serial};
    if (std::ranges::find(found.modules, address, &host::PlacedModule::address) != found.modules.end()) {
      throw std::runtime_error("two modules have the serial number " + hexadecimal(node.serial, 8) +
                               "; only one of them can be on the bus while node ids are given");
    }
    found.modules.push_back({node.node, address, std::nullopt});
  }
  if (found.modules.empty()) {
    throw std::runtime_error("found no joint module on the bus; " + bus.connection().diagnosis());
  }
  return found;
}

MovingJoint::MovingJoint(BusAccess& bus, std::uint8_t node, const host::JointMotionOptions& options)
    : bus_(bus), motion_(bus.connection(), node, options), attachment_(bus.connection(), motion_) {
  using State = host::JointMotion::State;
  constexpr Microseconds longest = 60 * second;  // the start of a motion ends by itself; this bounds one with a fault
  try {
    motion_.start(bus_.connection().now());
    bus_.wait_for("the joint to move", longest, [this] {
      take_events();
      return motion_.state() == State::moving || motion_.state() == State::failed;
    });
    if (motion_.state() == State::failed) {
      throw std::runtime_error(problem() + "; " + bus_.connection().diagnosis());
    }
  } catch (...) {
    stop_after_failure();
    throw;
  }
}

MovingJoint::~MovingJoint() {
  if (!is_off_) {
    stop_after_failure();
  }
}

void MovingJoint::take_events() {
  while (const auto event = motion_.take_event()) {
    is_confirmed_ = is_confirmed_ && event->kind != canopen::EventKind::not_stopped;
  }
}

std::string MovingJoint::problem() const {
  return problem_text(motion_.problem(), [](std::uint8_t node) { return "node " + std::to_string(node); });
}

bool MovingJoint::try_to_stop() {
  constexpr Microseconds longest = 20 * second;
  host::BusConnection& bus = bus_.connection();
  motion_.stop(bus.now());
  const bool is_stopped = bus.run_until(bus.now() + longest, [this] {
    take_events();
    return motion_.state() == host::JointMotion::State::stopped;
  });
  is_off_ = is_stopped && is_confirmed_ && motion_.lost_events() == 0;
  return is_off_;
}

void MovingJoint::stop_after_failure() noexcept {
  bool is_off = false;
  try {
    is_off = try_to_stop();
  } catch (const std::exception& error) {
    std::cerr << "proleg assign: " << error.what() << '\n';
  }
  if (!is_off) {
    std::cerr << "proleg assign: the module has not confirmed that its servo has no power: switch the robot off\n";
  }
}

void MovingJoint::stop() {
  if (!try_to_stop()) {
    is_off_ = true;  // once is enough
    throw std::runtime_error("the module has not confirmed that its servo has no power: switch the robot off");
  }
}

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

std::string Place::module_name() const {
  return node ? "the node id " + std::to_string(*node) : "the serial number " + hexadecimal(serial, 8);
}

namespace {

/// A node id, or a serial number as `proleg scan` shows it; nothing else.
std::optional<Place> parse_module(std::string_view word) {
  if (word.starts_with("0x") || word.starts_with("0X")) {
    const auto serial = parse_whole<std::uint32_t>(word.substr(2), 16);
    return serial ? std::optional(Place{std::nullopt, *serial, 0}) : std::nullopt;
  }
  const auto node = parse_whole<std::uint8_t>(word);
  return node ? std::optional(Place{*node, 0, 0}) : std::nullopt;
}

/// NODE=JOINT or SERIAL=JOINT.
std::optional<Place> parse_place(const sim::RobotModel& robot, std::string_view word) {
  const std::size_t equals = std::min(word.find('='), word.size());
  std::optional<Place> place = parse_module(word.substr(0, equals));
  const auto joint = equals < word.size() ? joint_of(robot, word.substr(equals + 1)) : std::nullopt;
  if (!place || !joint) {
    return std::nullopt;
  }
  place->joint = *joint;
  return place;
}

/// The comma behind the place that begins here, or the end. Names of joints may have commas: the longest name counts.
std::size_t end_of_place(const sim::RobotModel& robot, std::string_view words, std::size_t begin) {
  std::size_t end = std::min(words.find(',', begin), words.size());
  for (std::size_t comma = end; comma < words.size();) {
    comma = std::min(words.find(',', comma + 1), words.size());
    if (parse_place(robot, trimmed(words.substr(begin, comma - begin)))) {
      end = comma;
    }
  }
  return end;
}

}  // namespace

std::vector<Place> parse_places(const sim::RobotModel& robot, std::string_view words) {
  std::vector<Place> places;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = end_of_place(robot, words, begin);
    const std::string_view word = trimmed(words.substr(begin, end - begin));
    begin = end + 1;
    auto place = parse_place(robot, word);
    if (!place) {
      throw InputError("--places", 0, in_quotes(word),
                       "NODE=JOINT or SERIAL=JOINT, such as 3=J1 or 0x1A2B3C4D=J1; the joints are " +
                           listed(sim::joint_names(robot)));
    }
    for (const Place& other : places) {
      if ((other.node == place->node && other.serial == place->serial) || other.joint == place->joint) {
        throw InputError("--places", 0,
                         in_quotes(word) + " after " + other.module_name() + " for " + robot.joints[other.joint].name,
                         "each module and each joint once");
      }
    }
    places.push_back(*place);
  }
  return places;
}

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
    MovingJoint* moving, const host::PlacedModule& module,
    const std::function<std::optional<std::string>(unsigned joint)>& why_not) {
  for (;;) {
    report_.ask_for_joint(module);
    const std::string word = next_line(moving);
    if (const auto joint = joint_of(robot_, word)) {
      const auto reason = why_not(*joint);
      if (!reason) {
        return joint;
      }
      report_.refuse(*reason);
    } else if (const std::string command = lower_case(word); command == "none") {
      return std::optional<unsigned>();
    } else if (command == "more") {
      return More();
    } else if (command == "quit" || command == "q") {
      throw std::runtime_error("ended by the user");
    } else {
      report_.refuse(in_quotes(word) + " is none of " + choices());
    }
  }
}

std::optional<unsigned> AssignDialogue::ask_for_joint(
    const host::PlacedModule& module, host::JointMotionOptions options,
    const std::function<std::optional<std::string>(unsigned joint)>& why_not) {
  const Pause pause(presence_);
  for (;;) {
    std::optional<MovingJoint> moving;
    std::string problem;
    try {
      moving.emplace(bus_, module.node, options);
    } catch (const std::runtime_error& error) {
      if (interrupted() || !bus_.connection().state().is_connected) {
        throw;
      }
      problem = error.what();
    }
    if (moving) {
      report_.show_motion(module, moving->motion().amplitude());
    } else {
      report_.show_standstill(module, problem);
    }
    const Answer answer = ask_while(moving ? &*moving : nullptr, module, why_not);
    if (moving) {
      moving->stop();
    }
    if (const auto* joint = std::get_if<std::optional<unsigned>>(&answer)) {
      return *joint;
    }
    options.amplitude = std::min(2 * options.amplitude, largest_amplitude);
  }
}

bool AssignDialogue::ask_to_agree(std::span<const NodeChange> changes) {
  for (;;) {
    report_.ask_to_agree(changes);
    const std::string word = lower_case(next_line(nullptr));
    if (word == "y" || word == "yes") {
      return true;
    }
    if (word == "n" || word == "no") {
      return false;
    }
    report_.refuse(in_quotes(word) + " is none of yes, no");
  }
}

}  // namespace proleg::tools
