#include "sim/scenario/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/actuation_reader.hpp"
#include "sim/scenario/environment_reader.hpp"
#include "sim/scenario/plausibility.hpp"
#include "sim/scenario/robot_reader.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr Range durations{0.01, 86'400.0, "s"};
constexpr Range step_widths{1e-5, 0.02, "s"};
constexpr Range ticks{1.0, 100.0, "ms"};
constexpr Range probabilities{0.0, 1.0, ""};

Solver read_solver(const XmlElement& element) {
  constexpr std::array solvers{Solver::automatic, Solver::direct, Solver::iterative};
  return solvers[read_choice(element, {"automatic", "direct", "iterative"})];
}

void check_steps_in_tick(const XmlElement& place, const Scenario& scenario) {
  const double tick_s = scenario.kernel.tick_period_us * 1e-6;
  const double steps = std::round(tick_s / scenario.step_s);
  if (steps < 1.0 || std::abs(steps * scenario.step_s - tick_s) > 1e-9 * tick_s) {
    place.refuse(
        "a tick of " + number_text(tick_s * 1e3) + " ms with steps of " + number_text(scenario.step_s * 1e3) + " ms",
        "a tick that is a whole number of steps");
  }
}

/// Reports a tag of the thesis without a counterpart: any value but `off` asks for something that this program does not
/// do.
void remark_unless(const XmlElement& parent, std::string_view tag, std::string_view off, std::string_view reason,
                   std::vector<std::string>& remarks) {
  const std::optional<XmlElement> child = parent.child(tag);
  if (child && child->text() != off) {
    remark_no_effect(remarks, *child, reason);
  }
}

/// The command of this program that does what the thesis's simulation modes do (its section 4.3.3).
std::string reason_for_mode(std::string_view mode) {
  const std::string name = lower_case(mode);
  const auto has = [&name](std::string_view word) { return name.find(word) != std::string::npos; };
  if (has("real robot")) {
    return "it is a command here: 'proleg drive' moves a robot";
  }
  if (has("genetic") || has("deluge") || has("optimi")) {
    return "it is a command here: 'proleg optimise' searches, with an experiment file";
  }
  return "a scenario is a single run";
}

}  // namespace

void read_simulation_properties(const XmlElement& element, Scenario& scenario) {
  element.allow({}, {"stepWidth", "duration", "tick", "seed", "solver", "contactNoise", "showViewer",
                     "parallelComputing", "storingData", "mode", "accuracy"});
  if (const auto duration = element.child("duration")) {
    scenario.duration_s = read_quantity(*duration, durations);
  }
  const std::optional<XmlElement> step = element.child("stepWidth");
  if (step) {
    scenario.step_s = read_quantity(*step, step_widths);
  }
  const std::optional<XmlElement> tick = element.child("tick");
  if (tick) {
    scenario.kernel.tick_period_us = read_microseconds(*tick, ticks);
  }
  check_steps_in_tick(tick ? *tick : step.value_or(element), scenario);
  if (const auto seed = element.child("seed")) {
    scenario.kernel.seed = read_whole(*seed, 0, std::numeric_limits<std::uint64_t>::max());
  }
  if (const auto solver = element.child("solver")) {
    scenario.solver = read_solver(*solver);
  }
  if (const auto noise = element.child("contactNoise")) {
    scenario.contact_noise = read_number(*noise, probabilities);
  }

  std::vector<std::string>& remarks = scenario.remarks;
  remark_unless(element, "showViewer", "0", "'proleg ui' shows a robot that moves", remarks);
  remark_unless(element, "parallelComputing", "0", "one run uses one processor", remarks);
  remark_unless(element, "storingData", "0", "use --record on the command line", remarks);
  if (const auto mode = element.child("mode")) {
    remark_unless(element, "mode", "Single Run Simulation", reason_for_mode(mode->text()), remarks);
  }
  if (const auto accuracy = element.child("accuracy")) {
    remark_no_effect(remarks, *accuracy,
                     "it is how often the thesis's program samples; here every tick is recorded, and <tick> sets it");
  }
}

Scenario read_scenario(const std::filesystem::path& path, FileSource& files, const Overrides& overrides) {
  Scenario scenario;
  scenario.path = path.string();
  scenario.overrides = overrides;
  SourceSet sources(files, path, scenario.sources);
  const auto top = sources.open_top();
  const XmlElement root = top->root("simulation");
  root.allow({}, {"robot", "actuation", "environment", "simulationProperties", "sensor", "sensors"});
  const auto open = [&](std::string_view tag) {
    const XmlElement mention = root.required_child(tag);
    return sources.open(mention, mention.text());
  };

  if (const auto properties = root.child("simulationProperties")) {
    read_simulation_properties(*properties, scenario);
  }
  scenario.kernel.seed = overrides.seed.value_or(scenario.kernel.seed);
  for (const XmlElement& child : root.children()) {
    if (child.is("sensor") || child.is("sensors")) {
      remark_no_effect(scenario.remarks, child, "every link has two touch sensors under it");
    }
  }

  const auto robot_file = open("robot");
  scenario.robot_file = robot_file->name();
  RobotDescription robot = read_robot(*robot_file, scenario.step_s, sources, scenario.remarks);
  scenario.robot = std::move(robot.model);
  scenario.joint_limits = std::move(robot.kernel_limits);
  scenario.modules = std::move(robot.modules);
  scenario.robot_control = std::move(robot.robot_control);
  scenario.warnings = std::move(robot.warnings);
  scenario.kernel.joint_count = static_cast<std::uint8_t>(scenario.robot.joints.size());

  const auto actuation_file = open("actuation");
  scenario.actuation_file = actuation_file->name();
  read_actuation(*actuation_file, scenario, robot_file->name());

  const auto environment_file = open("environment");
  scenario.environment_file = environment_file->name();
  scenario.environment = read_environment(*environment_file, sources, scenario.remarks, scenario.warnings);
  apply_overrides(overrides, scenario.environment);
  if (scenario.environment.self_collision) {
    std::ranges::move(robot.contact_warnings, std::back_inserter(scenario.warnings));
  }
  lift_onto_ground(scenario.robot, scenario.environment, scenario.remarks);
  std::ranges::move(check_start(scenario.robot.links, scenario.environment, environment_file->name()),
                    std::back_inserter(scenario.warnings));
  return scenario;
}

}  // namespace proleg::sim
