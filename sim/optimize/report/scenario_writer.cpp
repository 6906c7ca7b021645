#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/gait/declaration.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/record/svg.hpp"
#include "sim/scenario/mesh_reader.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {
namespace {

/// A file to write.
struct FileCopy {
  std::filesystem::path place;  ///< relative path
  std::string text;
};

/// The robot and environment files of a scenario and all that they include, with places below one folder where their
/// references are valid.
struct ScenarioFiles {
  std::filesystem::path robot;
  std::filesystem::path environment;
  std::vector<FileCopy> copies;  ///< the robot and environment files, and all that they include
};

namespace fs = std::filesystem;

/// The files of the scenario, by their absolute paths.
class Sources {
 public:
  explicit Sources(const std::vector<sim::SourceFile>& files) : top_(full(files.front().path)) {
    for (const sim::SourceFile& file : files) {
      texts_.emplace(full(file.path), &file.text.str());
    }
  }

  /// The file that the reader found for a reference in `includer` (SourceSet::open); empty if it found none.
  [[nodiscard]] fs::path find(const fs::path& includer, const std::string& reference) const {
    for (const fs::path& folder : {includer.parent_path(), top_.parent_path()}) {
      if (const fs::path path = (folder / reference).lexically_normal(); texts_.contains(path)) {
        return path;
      }
    }
    return {};
  }

  /// The file that a tag of the top-level file names.
  [[nodiscard]] fs::path named_by_top(std::string_view tag) const {
    const sim::XmlDocument document(top_, text(top_), nullptr);
    return find(top_, document.root("simulation").required_child(tag).text());
  }

  /// The files with materials that an OBJ file beside them may name.
  [[nodiscard]] std::vector<fs::path> materials_beside(const fs::path& path) const {
    std::vector<fs::path> found;
    for (const auto& [other, text] : texts_) {
      if (lower_case(path.extension().string()) == ".obj" && lower_case(other.extension().string()) == ".mtl" &&
          other.parent_path() == path.parent_path()) {
        found.push_back(other);
      }
    }
    return found;
  }

  [[nodiscard]] const std::string& text(const fs::path& path) const { return *texts_.at(path); }

 private:
  static fs::path full(const std::string& path) { return fs::absolute(path).lexically_normal(); }

  fs::path top_;
  std::map<fs::path, const std::string*> texts_;
};

/// Whether the text of an element names a file: a mesh or heights.
bool names_file_in_text(const tinyxml2::XMLElement& element) {
  const std::string name = lower_case(element.Name());
  return name == "data" || name == "collision" || name == "render";
}

/// Calls use(reference, replace) for each file that a document names: in an attribute `file`, or in the text of mesh
/// and height elements. replace(text) writes another reference in its place. path: of the document.
template <typename Use>
void for_each_include(const Sources& sources, const fs::path& path, tinyxml2::XMLElement* element, const Use& use) {
  for (; element != nullptr; element = element->NextSiblingElement()) {
    for (const auto* attribute = element->FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
      if (lower_case(attribute->Name()) == "file") {
        use(std::string(trimmed(attribute->Value())),
            [&](const std::string& other) { element->SetAttribute(attribute->Name(), other.c_str()); });
      }
    }
    if (names_file_in_text(*element) && element->GetText() != nullptr) {
      const std::string text(trimmed(element->GetText()));
      const auto is_file = [&](const std::string& reference) { return !sources.find(path, reference).empty(); };
      const sim::FileText split = sim::split_file_text(text, is_file);
      use(std::string(split.path),
          [&](const std::string& other) { element->SetText((other + std::string(split.rest)).c_str()); });
    }
    for_each_include(sources, path, element->FirstChildElement(), use);
  }
}

/// Adds a file and, in turn, all that it includes.
void add_with_includes(const Sources& sources, const fs::path& path, std::set<fs::path>& files) {
  if (path.empty() || !files.insert(path).second) {
    return;
  }
  for (const fs::path& materials : sources.materials_beside(path)) {
    files.insert(materials);
  }
  tinyxml2::XMLDocument document;
  const std::string& text = sources.text(path);
  document.Parse(text.data(), text.size());
  for_each_include(sources, path, document.RootElement(), [&](const std::string& reference, const auto& /*replace*/) {
    add_with_includes(sources, sources.find(path, reference), files);
  });
}

fs::path common_folder(const std::set<fs::path>& files) {
  fs::path common = files.begin()->parent_path();
  for (const fs::path& file : files) {
    const fs::path folder = file.parent_path();
    const auto end = std::mismatch(common.begin(), common.end(), folder.begin(), folder.end()).first;
    fs::path shared;
    for (auto part = common.begin(); part != end; ++part) {
      shared /= *part;
    }
    common = shared;
  }
  return common;
}

/// Writes the engine's name into an environment file. Returns whether this changed the file.
bool set_engine(tinyxml2::XMLElement& environment, std::string_view engine) {
  tinyxml2::XMLElement* physics = environment.FirstChildElement();
  while (physics != nullptr && lower_case(physics->Name()) != "physicsengine") {
    physics = physics->NextSiblingElement();
  }
  if (physics == nullptr) {
    physics = environment.GetDocument()->NewElement("physicsengine");
    environment.InsertFirstChild(physics);
  }
  std::string name = "type";
  for (const auto* attribute = physics->FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    if (lower_case(attribute->Name()) == name) {
      name = attribute->Name();
      if (lower_case(attribute->Value()) == engine) {
        return false;
      }
      break;
    }
  }
  physics->SetAttribute(name.c_str(), std::string(engine).c_str());
  return true;
}

/// The text of a file, with references that are valid while the files keep their relative paths. engine: replaces that
/// of the environment file; empty: the file keeps its engine.
std::string text_to_write(const Sources& sources, const fs::path& path, std::string_view engine) {
  const std::string& text = sources.text(path);
  tinyxml2::XMLDocument document;
  document.Parse(text.data(), text.size());
  if (document.Error()) {
    return sim::bytes_of_source(text);  // the file is a mesh or heights
  }
  bool changed = !engine.empty() && set_engine(*document.RootElement(), engine);
  for_each_include(sources, path, document.RootElement(), [&](const std::string& reference, const auto& replace) {
    const fs::path target = sources.find(path, reference);
    const std::string wanted = target.lexically_relative(path.parent_path()).string();
    if (!target.empty() && reference != wanted) {
      replace(wanted);
      changed = true;
    }
  });
  if (!changed) {
    return text;
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

/// Collects the files. Below `root` they have the same paths as below their deepest common folder, so equal names in
/// different folders do not collide. Texts are copied byte by byte. Only paths that would become invalid are replaced
/// (absolute ones, and those relative to the folder of the top-level file), and an overridden engine. The scenario must
/// have been read from files.
ScenarioFiles collect_scenario_files(const sim::Scenario& scenario, const fs::path& root) {
  const Sources sources(scenario.sources);
  const fs::path robot = sources.named_by_top("robot");
  const fs::path environment = sources.named_by_top("environment");
  std::set<fs::path> files;
  add_with_includes(sources, robot, files);
  add_with_includes(sources, environment, files);

  const fs::path folder = common_folder(files);
  const auto place_of = [&](const fs::path& file) { return root / file.lexically_relative(folder); };
  ScenarioFiles result{place_of(robot), place_of(environment), {}};
  for (const fs::path& file : files) {
    const bool has_engine = file == environment && scenario.overrides.engine;
    result.copies.push_back(
        {place_of(file), text_to_write(sources, file, has_engine ? sim::name_of(*scenario.overrides.engine) : "")});
  }
  return result;
}

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
    for (const Setting& setting : scenario.settings) {
      if (setting.slot == slot && !setting.internal) {
        values_[setting.number][setting.joint] = setting.value;
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
  const std::string remark =
      (experiment.on_robot ? "Found by trials of a robot: " : "Found by an optimisation: ") +
      fs::path(experiment.path).filename().string() + ", method " + method_name(experiment.method) + "." +
      (experiment.trials.spread.any() ? " What its trials varied has the values of the original scenario." : "");
  return write_scenario(own_world(experiment, evaluation), remark, folder, name);
}

fs::path write_scenario(const sim::Scenario& scenario, const std::string& text, const fs::path& folder,
                        const std::string& name, const std::optional<std::string>& files_folder) {
  const ScenarioFiles files = collect_scenario_files(scenario, files_folder.value_or(name + ".files"));
  const std::string remark = "<!-- " + comment_text(text) + " -->\n";
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
