// proleg assign: gives the modules on a table their places in a robot.

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host/robot/joint_motion.hpp"
#include "host/robot/node_plan.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/names.hpp"
#include "tools/proleg/assign_bus.hpp"
#include "tools/proleg/bus_access.hpp"
#include "tools/proleg/input_lines.hpp"
#include "tools/proleg/scenario_run.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct AssignOptions : ScenarioOptions {
  BusOptions bus;
  std::optional<std::string> places;
  std::string amplitude = "5";
  bool yes = false;
};

constexpr std::int32_t largest_amplitude = raw(Unit::degree, 30);

std::int32_t parse_amplitude(const std::string& word) {
  const DecimalResult angle = parse_decimal(word, Unit::degree);
  if (angle.error != DecimalError::none || angle.raw < raw(Unit::degree, 1) || angle.raw > largest_amplitude) {
    throw InputError("--amplitude", 0, in_quotes(word), "degrees, from 1 to 30");
  }
  return angle.raw;
}

double degrees(std::int32_t angle) { return 90.0 * angle / quarter_turn; }

/// The joint that a user means: its name, in any case, or the number at the end of its name.
std::optional<unsigned> joint_of(const sim::RobotModel& robot, std::string_view word) {
  std::optional<unsigned> by_number;
  unsigned count = 0;
  for (unsigned joint = 0; joint < robot.joints.size(); ++joint) {
    const std::string name = lower_case(robot.joints[joint].name);
    if (name == lower_case(word)) {
      return joint;
    }
    if (name.substr(name.find_last_not_of("0123456789") + 1) == word) {
      by_number = joint;
      ++count;
    }
  }
  return count == 1 ? by_number : std::nullopt;
}

/// A module and its joint, as the user says.
struct Place {
  std::uint8_t node;
  unsigned joint;
};

/// "3=J1,1=J2"
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

/// A person, or a program in the place of one. Questions are on standard error, answers come by standard input.
class Operator {
 public:
  explicit Operator(BusAccess& bus) : bus_(bus) {}

  static void say(const std::string& text) { std::cerr << text << std::flush; }

  /// The next line. Throws std::runtime_error if the user ends the program, input ends, or `motion` fails.
  std::string answer(const host::JointMotion* motion = nullptr) {
    constexpr Microseconds patience = 600'000'000;
    std::optional<std::string> line;
    bus_.wait_for("an answer on standard input", patience, [&] {
      line = line ? line : lines_.next();
      const bool has_failed = motion != nullptr && motion->state() == host::JointMotion::State::failed;
      return line || lines_.has_ended() || has_failed;
    });
    if (!line) {
      throw std::runtime_error(lines_.has_ended() ? "standard input has ended without an answer"
                                                  : "the module does not move any more");
    }
    return std::string(trimmed(*line));
  }

 private:
  BusAccess& bus_;
  InputLines lines_;
};

class Assignment {
 public:
  Assignment(const AssignOptions& options, const sim::Scenario& scenario, BusAccess& bus,
             const std::vector<Place>& places, std::int32_t amplitude)
      : options_(options), scenario_(scenario), bus_(bus), places_(places), amplitude_(amplitude), operator_(bus) {
    for (const sim::ModulePlace& module : scenario.modules) {
      nodes_.push_back(module.node);
      serials_.push_back(module.serial.value_or(0));
    }
  }

  int run() {
    require_no_host(bus_);
    reset_all(bus_);
    number_fresh_modules(bus_, nodes_, serials_);
    modules_ = find_modules(bus_);
    take_serials();
    if (!places_.empty()) {
      take_places(places_);
    } else {
      ask_for_places();
    }
    const std::vector<canopen::RenumberedModule> changes = host::plan_node_ids(modules_, nodes_);
    if (!changes.empty()) {
      show(changes);
      renumber(bus_, changes);
      verify();
    }
    print_result(changes.size());
    return joints_without_module().empty() ? exit_success : exit_failed;
  }

 private:
  [[nodiscard]] const std::string& joint_name(unsigned joint) const { return scenario_.robot.joints[joint].name; }

  [[nodiscard]] host::PlacedModule* module_of(unsigned joint) {
    const auto module = std::ranges::find(modules_, std::optional(joint), &host::PlacedModule::joint);
    return module == modules_.end() ? nullptr : &*module;
  }

  [[nodiscard]] std::vector<std::string> joints_without_module() {
    std::vector<std::string> names;
    for (unsigned joint = 0; joint < nodes_.size(); ++joint) {
      if (module_of(joint) == nullptr) {
        names.push_back(joint_name(joint));
      }
    }
    return names;
  }

  /// Modules whose serial number the robot's file names need no question.
  void take_serials() {
    for (unsigned joint = 0; joint < serials_.size(); ++joint) {
      for (host::PlacedModule& module : modules_) {
        if (serials_[joint] != 0 && module.address.back() == serials_[joint]) {
          module.joint = joint;
        }
      }
    }
  }

  void take_places(const std::vector<Place>& places) {
    for (const Place& place : places) {
      const auto module = std::ranges::find(modules_, place.node, &host::PlacedModule::node);
      if (module == modules_.end()) {
        throw std::runtime_error("--places: no module with the node id " + std::to_string(place.node) +
                                 " is on the bus; nothing was changed");
      }
      module->joint = place.joint;
    }
  }

  void ask_for_places() {
    const std::size_t unknown = count_unplaced();
    if (unknown == 0) {
      return;
    }
    Operator::say("One joint after the other moves to and fro; all others have no power. Answer with its name (" +
                  listed(sim::joint_names(scenario_.robot)) +
                  "), none if no joint of this robot moves, more for a larger motion, or quit.\n");
    for (host::PlacedModule& module : modules_) {
      if (module.joint) {
        continue;
      }
      const std::vector<std::string> left = joints_without_module();
      if (left.empty()) {
        break;
      }
      if (left.size() == 1 && count_unplaced() == 1 && modules_.size() == nodes_.size()) {
        module.joint = joint_of(scenario_.robot, left.front());
        Operator::say("Node " + std::to_string(module.node) + " must be " + left.front() + ".\n");
        break;
      }
      module.joint = ask_for(module);
      unplaced_asked_ += module.joint ? 0U : 1U;
    }
  }

  [[nodiscard]] std::size_t count_unplaced() const {
    const auto without = std::ranges::count_if(modules_, [](const auto& module) { return !module.joint; });
    return static_cast<std::size_t>(without) - unplaced_asked_;
  }

  /// Angles that every joint of the robot may have.
  [[nodiscard]] canopen::AngleLimits common_limits() const {
    canopen::AngleLimits common{-(1 << 30), 1 << 30};
    for (const sim::JointLimits& limits : scenario_.joint_limits) {
      common.lower = std::max(common.lower, limits.lower);
      common.upper = std::min(common.upper, limits.upper);
    }
    return common.lower < common.upper ? common : canopen::AngleLimits{-amplitude_, amplitude_};
  }

  std::optional<unsigned> ask_for(const host::PlacedModule& module) {
    host::JointMotionOptions motion_options;
    motion_options.limits = common_limits();
    motion_options.amplitude = amplitude_;
    const std::string node = "Node " + std::to_string(module.node);
    for (;;) {
      MovingJoint moving(bus_, module.node, motion_options);
      Operator::say(node + " moves by " + number_text(degrees(moving.motion().amplitude())) +
                    " degrees. Which joint is it? ");
      for (;;) {
        const std::string word = operator_.answer(&moving.motion());
        if (word == "quit" || word == "q") {
          moving.stop();
          throw std::runtime_error("ended by the user; no node id was changed");
        }
        if (word == "none") {
          moving.stop();
          return std::nullopt;
        }
        if (word == "more") {
          motion_options.amplitude = std::min(2 * motion_options.amplitude, largest_amplitude);
          moving.stop();
          break;
        }
        const auto joint = joint_of(scenario_.robot, word);
        const host::PlacedModule* other = joint ? module_of(*joint) : nullptr;
        if (other != nullptr) {
          Operator::say(joint_name(*joint) + " is node " + std::to_string(other->node) +
                        " already. Which joint is it? ");
        } else if (joint) {
          moving.stop();
          return joint;
        } else {
          Operator::say(in_quotes(word) + " is none of " + listed(sim::joint_names(scenario_.robot)) +
                        ", none, more, quit. Which joint is it? ");
        }
      }
    }
  }

  void show(const std::vector<canopen::RenumberedModule>& changes) {
    for (const canopen::RenumberedModule& change : changes) {
      const auto module = std::ranges::find(modules_, change.address, &host::PlacedModule::address);
      Operator::say("node " + std::to_string(module->node) + " gets the node id " + std::to_string(change.node) +
                    (module->joint ? " (" + joint_name(*module->joint) + ")" : " (no joint of this robot)") + "\n");
    }
    if (options_.yes || !places_.empty()) {
      return;
    }
    Operator::say("Give the modules these node ids? [y/n] ");
    const std::string word = operator_.answer();
    if (word != "y" && word != "yes") {
      throw std::runtime_error("ended by the user; no node id was changed");
    }
  }

  /// Throws std::runtime_error if a joint does not have its module now.
  void verify() {
    const std::vector<host::PlacedModule> found = find_modules(bus_);
    for (host::PlacedModule& module : modules_) {
      const auto now = std::ranges::find(found, module.address, &host::PlacedModule::address);
      if (now == found.end()) {
        throw std::runtime_error("the module with the serial number " + hexadecimal(module.address.back(), 8) +
                                 " does not answer with its new node id; run proleg assign again");
      }
      module.node = now->node;
      if (module.joint && module.node != nodes_[*module.joint]) {
        throw std::runtime_error("the module of " + joint_name(*module.joint) + " still has the node id " +
                                 std::to_string(module.node) + "; run proleg assign again");
      }
    }
  }

  void print_result(std::size_t changes) {
    const std::vector<std::string> missing = joints_without_module();
    if (options_.json) {
      Json joints = Json::empty_array();
      for (unsigned joint = 0; joint < nodes_.size(); ++joint) {
        const host::PlacedModule* module = module_of(joint);
        joints.append({{"joint", joint_name(joint)},
                       {"node", module != nullptr ? Json(unsigned{module->node}) : Json()},
                       {"serial", module != nullptr ? Json(module->address.back()) : Json()}});
      }
      std::cout << Json{{"joints", joints}, {"changed", static_cast<unsigned>(changes)}}.text() << '\n';
    } else {
      std::printf("%-8s %-5s %s\n", "joint", "node", "serial");
      for (unsigned joint = 0; joint < nodes_.size(); ++joint) {
        if (const host::PlacedModule* module = module_of(joint)) {
          std::printf("%-8s %-5u %s\n", joint_name(joint).c_str(), unsigned{module->node},
                      hexadecimal(module->address.back(), 8).c_str());
        } else {
          std::printf("%-8s -\n", joint_name(joint).c_str());
        }
      }
      std::printf("%s\n", changes == 0 ? "no node id was changed" : "all modules have booted with these node ids");
    }
    if (!missing.empty()) {
      std::cerr << "proleg assign: no module was found for " << listed(missing) << '\n';
    }
  }

  const AssignOptions& options_;
  const sim::Scenario& scenario_;
  BusAccess& bus_;
  const std::vector<Place>& places_;
  std::int32_t amplitude_;  ///< 90 degrees = 2^30
  Operator operator_;
  std::vector<std::uint8_t> nodes_;     ///< by joint, as the robot's file says
  std::vector<std::uint32_t> serials_;  ///< by joint
  std::vector<host::PlacedModule> modules_;
  std::size_t unplaced_asked_ = 0;  ///< modules that move no joint of the robot
};

int assign(const AssignOptions& options) {
  const ScenarioRun run = prepare_run(options);
  print_warnings("proleg assign", run.scenario);
  if (run.scenario.modules.empty()) {
    throw InputError(options.file, 0, "a robot without <module>s", "a robot whose file gives its joints node ids");
  }
  const std::int32_t amplitude = parse_amplitude(options.amplitude);
  const std::vector<Place> places =
      options.places ? parse_places(run.scenario.robot, *options.places) : std::vector<Place>{};
  BusAccess bus(options.bus);
  catch_interrupts();
  return Assignment(options, run.scenario, bus, places, amplitude).run();
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg assign",
      "Gives the modules on a bus the node ids that the robot's file names. Modules without a node id get a free one. "
      "Then one joint after the other moves by a few degrees, and you answer which one it is. At the end the modules "
      "store their new node ids. It resets all modules first.");
  AssignOptions options;
  command_line.add_option("FILE", options.file, "a scenario (*.simulation.xml) with the robot").required();
  add_bus_option(command_line, options.bus);
  command_line
      .add_option("--places", options.places,
                  "which joint each module moves, by its present node id: 3=J1,1=J2. Then nothing moves and nothing is "
                  "asked")
      .value_name("NODE=JOINT,...");
  command_line.add_option("--amplitude", options.amplitude, "how far a joint moves to each side, 1 to 30 degrees (5)")
      .value_name("DEGREES");
  command_line.add_flag("--yes", options.yes, "do not ask before the node ids are changed");
  command_line.add_flag("--json", options.json, "print one JSON object");
  return command_line.run(argc, argv, [&] { return assign(options); });
}
