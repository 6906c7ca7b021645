// proleg assign: gives the modules on a table their places in a robot.

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/robot/node_plan.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/names.hpp"
#include "tools/proleg/common/program_report.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/robot/assign_report.hpp"
#include "tools/proleg/robot/assign_steps.hpp"
#include "tools/proleg/robot/bus_access.hpp"
#include "tools/proleg/robot/node_numbering.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct AssignOptions : ScenarioOptions {
  BusOptions bus;
  std::optional<std::string> places;
  std::string amplitude = "5";
  bool yes = false;
  ProgramReport report;
};

/// The options, checked.
struct AssignSettings {
  std::vector<Place> places;
  host::JointMotionOptions motion;
  bool asks = true;  ///< whether the user is asked before node ids are changed
  ProgramReport report;
};

std::int32_t parse_amplitude(const std::string& word) {
  const DecimalResult angle = parse_decimal(word, Unit::degree);
  if (angle.error != DecimalError::none || angle.raw < raw(Unit::degree, 1) ||
      angle.raw > AssignDialogue::largest_amplitude) {
    throw InputError("--amplitude", 0, in_quotes(word), "degrees, from 1 to 30");
  }
  return angle.raw;
}

/// Angles that every joint of the robot may have. Throws InputError if there is none.
AngleLimits common_limits(const sim::Scenario& scenario) {
  unsigned lowest = 0;
  unsigned highest = 0;
  const auto& limits = scenario.joint_limits;
  for (unsigned joint = 0; joint < limits.size(); ++joint) {
    lowest = limits[joint].lower > limits[lowest].lower ? joint : lowest;
    highest = limits[joint].upper < limits[highest].upper ? joint : highest;
  }
  if (limits[lowest].lower >= limits[highest].upper) {
    throw InputError("the robot", 0,
                     "no angle that the joints " + scenario.robot.joints[lowest].name + " and " +
                         scenario.robot.joints[highest].name + " have in common",
                     "--places: a joint that is not known could only move by an angle that all joints may have");
  }
  return {limits[lowest].lower, limits[highest].upper};
}

class Assignment {
 public:
  Assignment(const AssignSettings& settings, const sim::Scenario& scenario, BusAccess& bus)
      : settings_(settings),
        scenario_(scenario),
        bus_(bus),
        presence_(bus.connection()),
        report_(settings.report, scenario.robot),
        dialogue_(bus, presence_, scenario.robot, report_) {
    for (const sim::ModulePlace& module : scenario.modules) {
      nodes_.push_back(module.node);
      serials_.push_back(module.serial.value_or(0));
    }
  }

  int run() {
    find_named_nodes();
    reset_all(bus_);
    numbered_ = number_fresh_modules(bus_, nodes_, serials_);
    report_.show_numbered(numbered_);
    find();
    take_serials();
    if (settings_.places.empty()) {
      ask_for_places();
    } else {
      take_places();
    }
    auto steps = host::plan_node_ids(modules_, nodes_, others_);
    if (!steps) {
      throw std::runtime_error("two modules have one joint by their serial numbers, or no node id is free");
    }
    steps_ = std::move(*steps);
    if (!steps_.empty()) {
      const std::vector<NodeChange> changes = node_changes();
      report_.show_changes(changes);
      if (settings_.asks && !dialogue_.ask_to_agree(changes)) {
        throw std::runtime_error("ended by the user");
      }
      has_renumbered_ = true;
      renumber(bus_, steps_);
      verify();
    }
    print_result(!steps_.empty());
    return joints_without_module().empty() ? exit_success : exit_failed;
  }

  /// Whether modules may have stored node ids for their places.
  [[nodiscard]] bool has_renumbered() const { return has_renumbered_; }
  /// Shows the node id that each module has in its flash after a failure. Returns the rest of the command that goes on.
  [[nodiscard]] std::string show_places_to_go_on() const {
    const auto unfinished = std::ranges::find(steps_, false, &canopen::RenumberedModule::has_stored);
    std::string places;
    for (const host::PlacedModule& module : modules_) {
      unsigned node = module.node;
      for (const canopen::RenumberedModule& step : steps_) {
        node = step.address == module.address && step.has_stored ? unsigned{step.node} : node;
      }
      const bool is_uncertain = unfinished != steps_.end() && unfinished->address == module.address;
      const std::string serial = hexadecimal(module.address.back(), 8);
      std::cerr << "the module with the serial number " << serial << " ("
                << (module.joint ? joint_name(*module.joint) : "no joint of this robot") << ") has the node id " << node
                << (is_uncertain ? ", or " + std::to_string(unfinished->node) + " already" : "") << '\n';
      if (module.joint) {
        places += (places.empty() ? "" : ",") + serial + "=" + joint_name(*module.joint);
      }
    }
    return " --places " + shell_argument(places);
  }
  /// What was changed before that.
  [[nodiscard]] std::string changes() const {
    return numbered_ == 0 ? "no node id was changed"
                          : std::to_string(numbered_) + " modules that had no node id have one now";
  }

 private:
  [[nodiscard]] const std::string& joint_name(unsigned joint) const { return report_.joint_name(joint); }

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

  /// Finds the modules that --places names by the node ids that a scan shows: after a run that was cut some modules
  /// have others since the reset.
  void find_named_nodes() {
    if (std::ranges::none_of(settings_.places, [](const Place& place) { return place.node.has_value(); })) {
      return;
    }
    try {
      named_ = find_modules_to_number(bus_).modules;
    } catch (const std::runtime_error&) {
      if (interrupted() || !bus_.connection().state().is_connected) {
        throw;  // else the reset may bring modules back
      }
    }
  }

  [[nodiscard]] std::vector<host::PlacedModule>::iterator module_at(const Place& place) {
    if (!place.node) {
      return std::ranges::find_if(modules_, [&place](const auto& one) { return one.address.back() == place.serial; });
    }
    const auto named = std::ranges::find(named_, *place.node, &host::PlacedModule::node);
    return named != named_.end() ? std::ranges::find(modules_, named->address, &host::PlacedModule::address)
                                 : std::ranges::find(modules_, *place.node, &host::PlacedModule::node);
  }

  [[nodiscard]] std::string present_modules() const {
    std::vector<std::string> present;
    for (const host::PlacedModule& module : modules_) {
      present.push_back(hexadecimal(module.address.back(), 8) + " (node " + std::to_string(module.node) + ")");
    }
    return listed(present);
  }

  void find() {
    ModulesToNumber found = find_modules_to_number(bus_);
    modules_ = std::move(found.modules);
    others_ = std::move(found.others);
    for (unsigned joint = 0; joint < nodes_.size(); ++joint) {
      if (std::ranges::find(others_, nodes_[joint]) != others_.end()) {
        throw std::runtime_error("node " + std::to_string(nodes_[joint]) + ", which the robot's file gives to " +
                                 joint_name(joint) + ", is no joint module or does not answer: unplug it");
      }
    }
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

  /// Modules that --places does not name keep their places, unless a named one takes it.
  void take_places() {
    for (const Place& place : settings_.places) {
      const auto module = module_at(place);
      if (module == modules_.end()) {
        throw std::runtime_error("--places: no module with " + place.module_name() + " is on the bus, but " +
                                 present_modules());
      }
      const host::PlacedModule* other = module_of(place.joint);
      if ((other != nullptr && other != &*module) || (module->joint && *module->joint != place.joint)) {
        throw std::runtime_error("--places: by its serial number in the robot's file, node " +
                                 std::to_string(other != nullptr ? other->node : module->node) + " is " +
                                 joint_name(other != nullptr ? place.joint : *module->joint));
      }
      module->joint = place.joint;
    }
    for (unsigned joint = 0; joint < nodes_.size(); ++joint) {
      const auto module = std::ranges::find(modules_, nodes_[joint], &host::PlacedModule::node);
      if (module != modules_.end() && !module->joint && module_of(joint) == nullptr) {
        module->joint = joint;
      }
    }
  }

  void ask_for_places() {
    report_.show_places(modules_);
    if (std::ranges::all_of(modules_, [](const auto& module) { return module.joint.has_value(); })) {
      return;
    }
    host::JointMotionOptions motion = settings_.motion;
    motion.limits = common_limits(scenario_);
    report_.explain_questions();
    for (host::PlacedModule& module : modules_) {
      if (!module.joint && !joints_without_module().empty()) {
        module.joint = dialogue_.ask_for_joint(module, motion, [this](unsigned joint) {
          const host::PlacedModule* other = module_of(joint);
          return other == nullptr
                     ? std::nullopt
                     : std::optional(joint_name(joint) + " is node " + std::to_string(other->node) + " already");
        });
        report_.show_places(modules_);
      }
    }
  }

  [[nodiscard]] std::vector<NodeChange> node_changes() const {
    std::vector<NodeChange> changes;
    for (const host::PlacedModule& module : modules_) {
      // A module that is listed twice has the last node id.
      std::optional<unsigned> node;
      for (const canopen::RenumberedModule& step : steps_) {
        node = step.address == module.address ? std::optional(unsigned{step.node}) : node;
      }
      if (node) {
        changes.push_back({module.address.back(), module.node, *node, module.joint});
      }
    }
    return changes;
  }

  /// Throws std::runtime_error if a joint does not have its module now.
  void verify() {
    const std::vector<host::PlacedModule> found = find_modules_to_number(bus_).modules;
    for (host::PlacedModule& module : modules_) {
      const auto now = std::ranges::find(found, module.address, &host::PlacedModule::address);
      if (now == found.end()) {
        throw std::runtime_error("the module with the serial number " + hexadecimal(module.address.back(), 8) +
                                 " does not answer with its new node id");
      }
      module.node = now->node;
      if (module.joint && module.node != nodes_[*module.joint]) {
        throw std::runtime_error("the module of " + joint_name(*module.joint) + " still has the node id " +
                                 std::to_string(module.node));
      }
    }
  }

  [[nodiscard]] Json result_json(bool has_changed) {
    Json joints = Json::empty_array();
    for (unsigned joint = 0; joint < nodes_.size(); ++joint) {
      const host::PlacedModule* module = module_of(joint);
      joints.append({{"joint", joint_name(joint)},
                     {"node", module != nullptr ? Json(unsigned{module->node}) : Json()},
                     {"serial", module != nullptr ? Json(module->address.back()) : Json()}});
    }
    return {{"joints", joints}, {"changed", has_changed}, {"new_modules", numbered_}};
  }

  void print_table() {
    std::printf("%-8s %-5s %s\n", "joint", "node", "serial");
    for (unsigned joint = 0; joint < nodes_.size(); ++joint) {
      if (const host::PlacedModule* module = module_of(joint)) {
        std::printf("%-8s %-5u %s\n", joint_name(joint).c_str(), unsigned{module->node},
                    hexadecimal(module->address.back(), 8).c_str());
      } else {
        std::printf("%-8s -\n", joint_name(joint).c_str());
      }
    }
  }

  void print_result(bool has_changed) {
    if (settings_.report.is_text()) {
      print_table();
      std::printf("%s\n", has_changed ? "all modules have booted with these node ids" : changes().c_str());
    }
    settings_.report.print_result(result_json(has_changed));
    if (const std::vector<std::string> missing = joints_without_module(); !missing.empty()) {
      std::cerr << "proleg assign: no module was found for " << listed(missing) << '\n';
    }
  }

  const AssignSettings& settings_;
  const sim::Scenario& scenario_;
  BusAccess& bus_;
  HostPresence presence_;
  AssignReport report_;
  AssignDialogue dialogue_;
  std::vector<std::uint8_t> nodes_;     ///< by joint, as the robot's file says
  std::vector<std::uint32_t> serials_;  ///< by joint
  std::vector<host::PlacedModule> modules_;
  std::vector<host::PlacedModule> named_;  ///< modules before the reset, if --places names node ids
  std::vector<canopen::RenumberedModule> steps_;
  std::vector<std::uint8_t> others_;  ///< nodes that are no modules
  unsigned numbered_ = 0;             ///< modules that had no node id
  bool has_renumbered_ = false;
};

int assign(const AssignOptions& options) {
  const ScenarioRun run = prepare_run(options);
  print_warnings("proleg assign", run.scenario);
  AssignSettings settings;
  settings.motion.amplitude = parse_amplitude(options.amplitude);
  if (options.places) {
    settings.places = parse_places(run.scenario.robot, *options.places);
  }
  settings.asks = !options.yes && !options.places;
  settings.report = options.report;
  BusAccess bus(options.bus);
  catch_interrupts();
  // A reader of the questions or the events that ends must not end this program while a joint moves.
  std::signal(SIGPIPE, SIG_IGN);
  require_no_host(bus);
  Assignment assignment(settings, run.scenario, bus);
  try {
    return assignment.run();
  } catch (const std::exception& error) {
    if (assignment.has_renumbered()) {
      throw std::runtime_error(std::string(error.what()) + "; this goes on: proleg assign " +
                               shell_argument(options.file) +
                               (options.bus.bus ? " --bus " + shell_argument(*options.bus.bus) : "") +
                               assignment.show_places_to_go_on() + algorithm_options());
    }
    throw std::runtime_error(std::string(error.what()) + "; " + assignment.changes());
  }
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg assign",
      "Gives the modules on a bus the node ids that the robot's file names. Modules without a node id get a free one. "
      "Then one joint after the other moves by a few degrees, and you answer which one it is. At the end the modules "
      "store their new node ids. It resets all modules first.");
  AssignOptions options;
  add_scenario(command_line, options.file, "a scenario with the robot").required();
  add_bus_option(command_line, options.bus);
  command_line
      .add_option(
          "--places", options.places,
          "which joint each module moves, by its present node id or its serial number: 3=J1,0x1A2B3C4D=J2. Then "
          "nothing moves and nothing is asked")
      .value_name("MODULE=JOINT,...");
  command_line.add_option("--amplitude", options.amplitude, "how far a joint moves to each side, 1 to 30 degrees (5)")
      .value_name("DEGREES");
  command_line.add_flag("--yes", options.yes, "do not ask before the node ids are changed");
  options.report.add_options(command_line);
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return assign(options); });
}
