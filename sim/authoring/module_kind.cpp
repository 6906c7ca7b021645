#include "sim/authoring/module_kind.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <map>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/scenario_text.hpp"
#include "sim/scenario/values.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view folder_beginning = "modules_";
constexpr std::string_view mark = "Module of its own,";  // how the comment of such a module begins
constexpr std::array<ModuleRole, 3> roles{tail_role, segment_role, head_role};
constexpr Range module_lengths{0.001, 5.0, "m"};

const ModuleRole* role_of(const std::string& file) {
  const auto* const found = std::ranges::find(roles, file, &ModuleRole::file);
  return found == roles.end() ? nullptr : found;
}

std::string comment_of(const ModuleRole& role, double length) {
  return "<!-- " + std::string(mark) + " " + length_text(length) + " m between its joints. " +
         std::string(role.comment) + " -->";
}

std::string kinbody_name(const ModuleRole& role) { return std::string(role.file.substr(0, role.file.find('.'))); }

std::string own_module_text(const ModuleRole& role, const OwnMesh& mesh, const OwnModule& module) {
  const FittedBox box = fitted_box(mesh.facts, module.fit);
  const Eigen::Vector3d middle(0.0, role.side * module.length / 2.0, 0.0);
  const std::string lines = mesh_lines(mesh.files.front().name, module.fit, middle - (box.lowest + box.highest) / 2.0);
  std::string text = comment_of(role, module.length) + "\n<KinBody name=\"" + kinbody_name(role) +
                     "\">\n  <Body name=\"" + std::string(role.body) +
                     "\" type=\"dynamic\">\n    <Geom type=\"trimesh\">\n";
  TextLines all(lines);
  while (const std::optional<std::string_view> line = all.next()) {
    if (!line->empty()) {
      text.append("      ").append(*line).append("\n");
    }
  }
  return text + "    </Geom>\n    <Mass type=\"mimicgeom\">\n      <total>" + number_text_of(module.mass) +
         "</total>\n    </Mass>\n  </Body>\n</KinBody>\n";
}

/// The length of a module that own_module_text() has written; nothing for another one.
std::optional<double> length_of(const XmlText& xml) {
  const auto comment = xml.comment_with(mark);
  if (!comment) {
    return std::nullopt;
  }
  const std::string_view text = std::string_view(xml.text()).substr(comment->begin, comment->end - comment->begin);
  const std::vector<std::string_view> rest = words(text.substr(text.find(',') + 1));
  return rest.empty() ? std::nullopt : parse_number_in(rest.front(), module_lengths);
}

/// The module of a role, made from that of another one, which a person may have changed.
std::string with_role(const std::string& name, std::string text, const ModuleRole& from, const ModuleRole& to,
                      double length) {
  const auto edit = [&](const std::function<TextPatch(const XmlText&)>& patch) {
    const XmlText xml(name, text);
    sim::apply(patch(xml), text);
  };
  edit([&](const XmlText& xml) { return xml.replace(xml.comment_with(mark).value(), comment_of(to, length)); });
  edit([&](const XmlText& xml) { return xml.set_attribute(0, "name", kinbody_name(to)); });
  edit([&](const XmlText& xml) { return xml.set_attribute(xml.child(0, "Body").value(), "name", to.body); });
  if (from.side == to.side) {
    return text;
  }
  const std::size_t geometries = XmlText(name, text).children(1, "Geom").size();
  for (std::size_t i = 0; i < geometries; ++i) {
    edit([&](const XmlText& xml) {
      const ElementNumber geom = xml.children(1, "Geom")[i];
      Eigen::Vector3d position = pose_of(xml, geom).position;
      position.y() += (to.side - from.side) * length / 2.0;
      const std::optional<ElementNumber> translation = xml.child(geom, "Translation");
      return translation ? xml.set_content(*translation, vector_text(position))
                         : xml.add_first(geom, element_text("Translation", vector_text(position)));
    });
  }
  return text;
}

/// Whether it has the form that own_module_text() writes.
bool is_own_module(const XmlText& xml) {
  const std::optional<ElementNumber> body = xml.child(0, "Body");
  return length_of(xml) && body == ElementNumber{1} && xml.children(0).size() == 1;
}

}  // namespace

ModuleKind module_kind(const RobotKind& kind) {
  ModuleKind result{std::string(kind.name), static_cast<double>(kind.module_mm) / 1000.0, module_files(kind)};
  for (SourceFile& file : result.files) {
    file.path = fs::path(file.path).filename().string();
  }
  return result;
}

ModuleKind own_module_kind(const OwnMesh& mesh, const OwnModule& module) {
  require_fit(module.fit);
  const bool is_name = !module.name.empty() && module.name.front() != '.' &&
                       module.name.find_first_of("/\\\"<>&") == std::string::npos && is_visible_line(module.name) &&
                       trimmed(module.name) == module.name && shortened(module.name, 30) == module.name;
  if (!is_name || find_robot_kind(module.name) != nullptr) {
    throw InputError("name", 0, in_quotes(one_line(module.name)),
                     "a new name for the kind of module: 1 to 30 characters, without a folder");
  }
  const auto require_in = [](const char* name, double value, const Range& range) {
    if (!(value >= range.min && value <= range.max)) {
      throw InputError(
          name, 0, number_text(value),
          "a number from " + number_text(range.min) + " to " + number_text(range.max) + " " + std::string(range.unit));
    }
  };
  require_in("length", module.length, module_lengths);
  require_in("mass", module.mass, masses);
  if (!mesh.facts.hull_volume) {
    throw InputError(mesh.files.front().name, 0, "a mesh whose points lie in a plane", "a solid");
  }
  ModuleKind kind{module.name, module.length, source_files(mesh)};
  for (const ModuleRole& role : roles) {
    kind.files.push_back({std::string(role.file), own_module_text(role, mesh, module)});
  }
  return kind;
}

std::vector<ModuleKind> own_kinds(const Scenario& scenario) {
  const fs::path robot_folder = fs::path(scenario.robot_file).parent_path();
  std::map<std::string, ModuleKind> kinds;  // by the folder
  for (const SourceFile& source : scenario.sources) {
    const fs::path path(source.path);
    const std::string folder = path.parent_path().filename().string();
    const ModuleRole* const role = role_of(path.filename().string());
    if (role == nullptr || !folder.starts_with(folder_beginning) || kinds.contains(folder) ||
        path.parent_path().parent_path().lexically_normal() != robot_folder.lexically_normal()) {
      continue;
    }
    const XmlText xml(source.path, source.text);
    if (!is_own_module(xml)) {
      continue;
    }
    ModuleKind kind{folder.substr(folder_beginning.size()), *length_of(xml), {}, folder};
    for (const ModuleRole& other : roles) {
      kind.files.push_back({std::string(other.file), with_role(source.path, source.text, *role, other, kind.length)});
    }
    kinds.emplace(folder, std::move(kind));
  }
  std::vector<ModuleKind> all;
  all.reserve(kinds.size());
  for (auto& [folder, kind] : kinds) {
    all.push_back(std::move(kind));
  }
  return all;
}

}  // namespace proleg::sim
