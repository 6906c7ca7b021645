#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "sim/authoring/robot_kinds.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/robot_move.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/settings.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/new/robot_options.hpp"
#include "tools/python/module/conversions.hpp"
#include "tools/python/module/parts.hpp"

namespace py = pybind11;

namespace proleg::python {
namespace {

using sim::Scenario;

using Words = std::map<std::string, std::string>;  ///< of options, by their names

sim::OverrideWords overrides_of(const Words& words) {
  sim::OverrideWords overrides;
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const auto word = words.find(std::string(declaration.name)); word != words.end()) {
      overrides.*declaration.word = word->second;
    }
  }
  return overrides;
}

Words override_words(const sim::Overrides& overrides) {
  const sim::OverrideWords given = sim::words_of(overrides);
  Words words;
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& word = given.*declaration.word) {
      words.emplace(declaration.name, *word);
    }
  }
  return words;
}

Scenario read(const std::string& path, const Words& overrides) {
  tools::refuse_folder(path, tools::scenario_extension);
  sim::DiskFiles files;
  return sim::read_scenario(path, files, sim::read_overrides(overrides_of(overrides)));
}

Scenario read_sources(const std::vector<sim::SourceFile>& sources, const std::string& path, const Words& overrides) {
  sim::SourceTexts files;
  for (const sim::SourceFile& source : sources) {
    files.add(source.path, source.text);
  }
  return sim::read_scenario(path, files, sim::read_overrides(overrides_of(overrides)));
}

Scenario make(const std::string& kind_name, std::optional<std::uint32_t> joints,
              const std::optional<std::string>& axes) {
  tools::RobotOptions options{kind_name, std::nullopt, axes};
  if (joints) {
    options.joints = std::to_string(*joints);
  }
  const std::vector<sim::SourceFile> files = tools::robot_files(options);
  return read_sources(files, files.front().path, {});
}

/// The scenario with other overrides, and with all that was changed since it was read.
Scenario with_overrides(const Scenario& scenario, const Words& overrides) {
  Scenario other = read_sources(scenario.sources, scenario.path, overrides);
  other.settings = scenario.settings;
  other.changes = scenario.changes;
  other.moves = scenario.moves;
  other.duration_s = scenario.duration_s;
  return other;
}

double number_of(std::int32_t raw, Unit unit) { return parse_number(format_decimal(raw, unit).view()).value_or(0.0); }

/// The start values of a parameter: the joints that have it, from the head, and their values.
std::pair<std::vector<std::string>, std::vector<double>> values_of(const Scenario& scenario, const std::string& name) {
  const sim::SettingTarget target = sim::find_named_target(scenario, name);
  if (target.internal) {
    throw InputError(shortened(name), 0, "an internal value, which the algorithm computes", "a parameter");
  }
  std::pair<std::vector<std::string>, std::vector<double>> values;
  for (unsigned joint = 0; joint < scenario.kernel.joint_count; ++joint) {
    if (target.joints.contains(joint)) {
      values.first.push_back(scenario.robot.joints[joint].name);
      values.second.push_back(number_of(sim::start_value(scenario, target.slot, joint, target.number), target.unit));
    }
  }
  return values;
}

/// What can be set, for each algorithm of the scenario: its position from 1, its name, its parameters.
py::list parameters_of(const Scenario& scenario) {
  py::list all;
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    if (scenario.kernel.slots[slot].algorithm == nullptr) {
      continue;
    }
    const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
    for (const Parameter& parameter : declaration.parameters) {
      all.append(py::make_tuple(slot + 1, std::string(declaration.name), std::string(parameter.name),
                                sim::shown_unit(parameter.unit), number_of(parameter.minimum, parameter.unit),
                                number_of(parameter.maximum, parameter.unit),
                                number_of(parameter.default_value, parameter.unit), std::string(parameter.help)));
    }
  }
  return all;
}

std::vector<std::pair<std::string, std::string>> files_of(const Scenario& scenario) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const sim::SourceFile& source : scenario.sources) {
    files.emplace_back(source.path, source.text.str());
  }
  return files;
}

py::list setting_tuples(const std::vector<Setting>& settings) {
  py::list tuples;
  for (const Setting& setting : settings) {
    tuples.append(py::make_tuple(setting.slot, setting.joint, setting.number, setting.internal, setting.value));
  }
  return tuples;
}

std::vector<Setting> settings_of(const py::handle& tuples) {
  std::vector<Setting> settings;
  for (const py::handle tuple : tuples) {
    const auto [slot, joint, number, internal, value] =
        tuple.cast<std::tuple<std::uint8_t, std::uint8_t, std::uint8_t, bool, std::int32_t>>();
    settings.push_back({slot, joint, number, internal, value});
  }
  return settings;
}

/// For pickle: processes of a pool, and copies on disk.
py::tuple state_of(const Scenario& scenario) {
  py::list changes;
  for (const Change& change : scenario.changes) {
    changes.append(py::make_tuple(change.tick, setting_tuples(change.settings)));
  }
  std::vector<std::string> moves;
  for (const sim::RobotMove& move : scenario.moves) {
    moves.push_back(sim::move_text(move));
  }
  return py::make_tuple(scenario.path, files_of(scenario), override_words(scenario.overrides),
                        setting_tuples(scenario.settings), changes, moves, scenario.duration_s);
}

/// Throws InputError if the state names a joint or a parameter that the files do not have.
Scenario scenario_of(const py::tuple& state) {
  constexpr std::size_t parts = 7;
  if (state.size() != parts) {
    throw InputError("the state of a Scenario", 0, std::to_string(state.size()) + " parts", "7");
  }
  std::vector<sim::SourceFile> sources;
  for (const auto& [path, text] : state[1].cast<std::vector<std::pair<std::string, std::string>>>()) {
    sources.push_back({path, sim::SharedText(text)});
  }
  Scenario scenario = read_sources(sources, state[0].cast<std::string>(), state[2].cast<Words>());
  const auto checked = [&](std::vector<Setting> settings) {
    for (const Setting& setting : settings) {
      const Slot* const slot = setting.slot < max_slots ? &scenario.kernel.slots[setting.slot] : nullptr;
      const bool is_known = slot != nullptr && slot->algorithm != nullptr && slot->group.contains(setting.joint) &&
                            setting.number < (setting.internal ? slot->algorithm->declaration().internal_values.size()
                                                               : slot->algorithm->declaration().parameters.size());
      if (!is_known) {
        throw InputError("the state of a Scenario", 0, "a setting of an unknown parameter", "those of its files");
      }
    }
    return settings;
  };
  scenario.settings = checked(settings_of(state[3]));
  scenario.changes.clear();
  for (const py::handle change : state[4]) {
    const auto [tick, settings] = change.cast<std::pair<std::uint32_t, py::list>>();
    scenario.changes.push_back({tick, checked(settings_of(settings))});
  }
  scenario.moves.clear();
  for (const std::string& move : state[5].cast<std::vector<std::string>>()) {
    sim::add_move(scenario, move);
  }
  scenario.duration_s = state[6].cast<double>();
  return scenario;
}

/// What a scenario has that its files cannot say; nothing: they can say all of it.
std::optional<std::string> unwritten_part(const Scenario& scenario) {
  if (!scenario.changes.empty()) {
    return "a change while the robot moves";
  }
  if (!scenario.moves.empty()) {
    return "a move of the robot";
  }
  const sim::Overrides& overrides = scenario.overrides;
  return overrides.friction || overrides.at || overrides.heading_deg
             ? std::optional<std::string>("another friction, place or heading than its environment")
             : std::nullopt;
}

std::string save(const Scenario& scenario, const std::string& path, bool replaces) {
  const std::filesystem::path file(path);
  const std::string name = file.filename().string();
  const std::size_t end = name.size() - std::min(name.size(), std::strlen(tools::scenario_extension));
  if (end == 0 || name.substr(end) != tools::scenario_extension) {
    throw InputError("file", 0, in_quotes(path), std::string("a name with the end ") + tools::scenario_extension);
  }
  if (const std::optional<std::string> unwritten = unwritten_part(scenario)) {
    throw InputError(path, 0, "a scenario with " + *unwritten,
                     "one that files can say; simulate() and --set have the rest");
  }
  if (tools::is_shipped(file)) {
    throw InputError(path, 0, "a file of the scenarios that ship with Proleg", "a file of your own");
  }
  std::error_code error;
  if (!replaces && std::filesystem::exists(file, error)) {
    throw InputError(path, 0, "a file", "a new name, or replace=True");
  }
  return optimize::write_scenario(scenario, "Written by Python.", std::filesystem::absolute(file).parent_path(),
                                  name.substr(0, end))
      .string();
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& items) {
  std::vector<std::string> names;
  std::ranges::transform(items, std::back_inserter(names), &Named::name);
  return names;
}

}  // namespace

void add_scenario(py::module_& module) {
  py::class_<Scenario>(module, "Scenario")
      .def(py::init(&read), py::arg("path"), py::arg("overrides"))
      .def_readonly("path", &Scenario::path)
      .def_readonly("warnings", &Scenario::warnings)
      .def_readonly("remarks", &Scenario::remarks)
      .def_readonly("duration", &Scenario::duration_s)
      .def_readonly("step", &Scenario::step_s)
      .def_property_readonly("tick", [](const Scenario& scenario) { return scenario.kernel.tick_period_us * 1e-6; })
      .def_property_readonly("seed", [](const Scenario& scenario) { return scenario.kernel.seed; })
      .def_property_readonly(
          "engine", [](const Scenario& scenario) { return std::string(sim::name_of(scenario.environment.engine)); })
      .def_property_readonly("overrides", [](const Scenario& scenario) { return override_words(scenario.overrides); })
      .def_property_readonly("joints", [](const Scenario& scenario) { return names_of(scenario.robot.joints); })
      .def_property_readonly("links", [](const Scenario& scenario) { return names_of(scenario.robot.links); })
      .def_property_readonly("parameters", &parameters_of)
      .def_property_readonly("files", &files_of)
      .def("values", &values_of, py::arg("name"))
      .def("set",
           [](Scenario& scenario, const std::string& name, double value, const std::optional<double>& time_s) {
             sim::apply_setting(scenario, name + '=' + word_of(value) + (time_s ? '@' + word_of(*time_s) + 's' : ""));
           })
      .def("set_duration",
           [](Scenario& scenario, double seconds) { tools::set_duration(scenario, "duration", word_of(seconds)); })
      .def("move", [](Scenario& scenario, const std::string& word) { sim::add_move(scenario, word); })
      .def("with_overrides", &with_overrides, py::arg("overrides"))
      .def("save", &save, py::arg("file"), py::arg("replace"))
      .def("copy", [](const Scenario& scenario) { return scenario; })
      .def(py::pickle(&state_of, &scenario_of))
      // Python's own way of protocols 0 and 1 makes an object of pybind11's base class, which ends the process.
      .def("__reduce__", [](const py::object& scenario) {
        return py::make_tuple(py::module_::import("copyreg").attr("__newobj__"), py::make_tuple(py::type::of(scenario)),
                              scenario.attr("__getstate__")());
      });
  module.def("make", &make, py::arg("kind"), py::arg("joints"), py::arg("axes"));
  module.def(
      "shipped_file",
      [](const std::string& word, const std::optional<std::string>& folder) {
        return tools::scenario_file(word, folder ? std::optional<std::filesystem::path>(*folder) : std::nullopt);
      },
      py::arg("word"), py::arg("folder"));
  py::list shipped;
  for (const tools::ShippedScenario& scenario : tools::shipped_scenarios()) {
    shipped.append(std::string(scenario.name));
  }
  module.attr("shipped_names") = py::tuple(shipped);
}

}  // namespace proleg::python
