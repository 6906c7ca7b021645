#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <system_error>

#include "shared/computer/errors/file_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/gait/declaration.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scenario_files.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/record/svg.hpp"

namespace proleg::optimize {
namespace {

namespace fs = std::filesystem;

/// Text for <!-- -->, which must not contain two hyphens in a row.
std::string comment_text(std::string_view text) {
  std::string result;
  for (const char c : one_line(text)) {
    result += c == '-' && result.ends_with('-') ? " -" : std::string(1, c);
  }
  return result + (result.ends_with('-') ? " " : "");
}

/// Start values of a slot: for each parameter the values of all joints, in kernel order.
class StartValues {
 public:
  StartValues(const sim::Scenario& scenario, std::size_t slot) {
    const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
    for (std::size_t p = 0; p < declaration.parameters.size(); ++p) {
      values_[p].fill(declaration.parameters[p].default_value);
    }
    for (const sim::Setting& setting : scenario.settings) {
      if (setting.slot == slot && !setting.internal) {
        values_[setting.index][setting.joint] = setting.value;
      }
    }
  }
  [[nodiscard]] std::int32_t at(std::size_t parameter, std::size_t joint) const { return values_[parameter][joint]; }

 private:
  std::array<std::array<std::int32_t, max_joints>, max_parameters> values_{};
};

std::string parameter_line(const Parameter& parameter, std::int32_t value, const std::string* joint) {
  const std::string_view unit = scale_of(parameter.unit).symbol;
  return "    <parameter name=\"" + std::string(parameter.name) + "\" value=\"" +
         std::string(format_decimal(value, parameter.unit).view()) + "\"" +
         (unit.empty() ? "" : " unit=\"" + std::string(unit) + "\"") +
         (joint == nullptr ? "" : " joint=\"" + sim::xml_text(*joint) + "\"") + "/>\n";
}

/// Joints that a slot drives, in the order of the robot file.
std::vector<std::size_t> driven_joints(const sim::Scenario& scenario, std::size_t slot) {
  std::vector<std::size_t> joints;
  for (std::size_t j = 0; j < scenario.robot.joints.size(); ++j) {
    if (scenario.kernel.slots[slot].group.contains(static_cast<unsigned>(j))) {
      joints.push_back(j);
    }
  }
  std::ranges::sort(joints, {}, [&](std::size_t j) { return scenario.robot.joints[j].file_index; });
  return joints;
}

std::string module_text(const sim::Scenario& scenario, std::size_t slot) {
  const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
  const std::vector<std::size_t> joints = driven_joints(scenario, slot);
  std::string mask(scenario.robot.joints.size(), '0');
  for (const std::size_t j : joints) {
    mask[scenario.robot.joints[j].file_index] = '1';
  }
  std::string text = "  <actuationModule name=\"" + std::string(declaration.name) +
                     "\">\n    <jointConfiguration joints=\"" + mask + "\"/>\n";
  const StartValues values(scenario, slot);
  for (std::size_t p = 0; p < declaration.parameters.size() && !joints.empty(); ++p) {
    const std::int32_t first = values.at(p, joints.front());
    if (std::ranges::all_of(joints, [&](std::size_t j) { return values.at(p, j) == first; })) {
      text += parameter_line(declaration.parameters[p], first, nullptr);
      continue;
    }
    for (const std::size_t j : joints) {
      text += parameter_line(declaration.parameters[p], values.at(p, j), &scenario.robot.joints[j].name);
    }
  }
  return text + "  </actuationModule>\n";
}

std::string actuation_text(const sim::Scenario& scenario, const std::string& robot_file, const std::string& remark) {
  std::string text = remark + "<actuation>\n  <validRobot robotName=\"" + sim::xml_text(robot_file) + "\"/>\n";
  for (std::size_t slot = 0; slot < max_slots; ++slot) {
    if (scenario.kernel.slots[slot].algorithm != nullptr) {
      text += module_text(scenario, slot);
    }
  }
  return text + "</actuation>\n";
}

std::string_view solver_name(sim::Solver solver) {
  switch (solver) {
    case sim::Solver::direct:
      return "direct";
    case sim::Solver::iterative:
      return "iterative";
    case sim::Solver::automatic:
      break;
  }
  return "automatic";
}

std::string top_text(const sim::Scenario& scenario, const ScenarioFiles& files, const std::string& actuation,
                     const std::string& remark) {
  const auto element = [](std::string_view indent, std::string_view tag, std::string_view text) {
    return std::string(indent) + "<" + std::string(tag) + ">" + sim::xml_text(text) + "</" +
           std::string(tag.substr(0, tag.find(' '))) + ">\n";
  };
  return remark + "<simulation>\n" + element("  ", "robot", files.robot.generic_string()) +
         element("  ", "actuation", actuation) + element("  ", "environment", files.environment.generic_string()) +
         "  <simulationProperties>\n" + element("    ", "stepWidth", exact_text(scenario.step_s)) +
         element("    ", "tick unit=\"ms\"", sim::plain_number(scenario.kernel.tick_period_us / 1000.0, 3)) +
         element("    ", "duration", exact_text(scenario.duration_s)) +
         element("    ", "seed", std::to_string(scenario.kernel.seed)) +
         element("    ", "solver", solver_name(scenario.solver)) +
         (scenario.contact_noise == 0.0 ? "" : element("    ", "contactNoise", exact_text(scenario.contact_noise))) +
         "  </simulationProperties>\n</simulation>\n";
}

void write_with_folder(const fs::path& path, std::string_view text) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) {
    throw FileError(path.parent_path(), "cannot be created: " + error.message());
  }
  write_file(path, text);
}

}  // namespace

fs::path write_scenario(const Experiment& experiment, const Evaluation& evaluation, const fs::path& folder,
                        const std::string& name) {
  if (experiment.scenario.sources.empty()) {
    throw FileError(folder, "no scenario is written there: that of the experiment was not read from files");
  }
  const sim::Scenario scenario = own_world(experiment, evaluation);
  const ScenarioFiles files = collect_scenario_files(scenario, name + ".files");
  const std::string remark =
      "<!-- Found by an optimisation: " + comment_text(fs::path(experiment.path).filename().string()) + ", method " +
      comment_text(method_name(experiment.method)) + "." +
      (experiment.trials.spread.any() ? " What its trials varied has the values of the original scenario." : "") +
      " -->\n";

  for (const FileCopy& file : files.copies) {
    write_with_folder(folder / file.place, file.text);
  }
  const std::string actuation = name + ".actuation.xml";
  write_with_folder(folder / actuation, actuation_text(scenario, files.robot.filename().string(), remark));
  // The top-level file is written last: if it exists, the others exist.
  const fs::path top = folder / (name + ".simulation.xml");
  write_with_folder(top, top_text(scenario, files, actuation, remark));
  return top;
}

}  // namespace proleg::optimize
