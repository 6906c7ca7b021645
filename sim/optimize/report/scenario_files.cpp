#include "sim/optimize/report/scenario_files.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/data_url.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {
namespace {

namespace fs = std::filesystem;

/// The files of the scenario, by their absolute paths.
class Sources {
 public:
  explicit Sources(const std::vector<sim::SourceFile>& files) : top_(full(files.front().path)) {
    for (const sim::SourceFile& file : files) {
      texts_.emplace(full(file.path), &file.text);
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

/// Calls use(reference, replace) for each file that a document names: in an attribute `file`, or as the first word of
/// the text of mesh and height elements. replace(text) writes another reference in its place.
template <typename Use>
void for_each_include(tinyxml2::XMLElement* element, const Use& use) {
  for (; element != nullptr; element = element->NextSiblingElement()) {
    for (const auto* attribute = element->FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
      if (lower_case(attribute->Name()) == "file") {
        use(std::string(trimmed(attribute->Value())),
            [&](const std::string& other) { element->SetAttribute(attribute->Name(), other.c_str()); });
      }
    }
    if (names_file_in_text(*element) && element->GetText() != nullptr) {
      const std::string text(trimmed(element->GetText()));
      const std::string reference = text.substr(0, text.find_first_of(" \t\r\n"));
      use(reference,
          [&](const std::string& other) { element->SetText((other + text.substr(reference.size())).c_str()); });
    }
    for_each_include(element->FirstChildElement(), use);
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
  for_each_include(document.RootElement(), [&](const std::string& reference, const auto& /*replace*/) {
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
  for_each_include(document.RootElement(), [&](const std::string& reference, const auto& replace) {
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

}  // namespace

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

}  // namespace proleg::optimize
