#include "sim/authoring/module_change.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/chain_text.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

struct Role {
  std::string_view file;  ///< in the folder of the modules
  std::string_view body;
};
constexpr Role tail_role{"tail.kinbody.xml", "Tail"};
constexpr Role segment_role{"segment.kinbody.xml", "Seg"};
constexpr Role head_role{"head.kinbody.xml", "Head"};

/// Adds the files of a kind to the draft, in a folder that has no other files of these names. Returns the folder,
/// relative to that of the robot's file.
std::string add_module_files(DraftChange& change, const std::string& robot_file, const RobotKind& kind) {
  const std::filesystem::path folder = std::filesystem::path(robot_file).parent_path();
  for (unsigned number = 1;; ++number) {
    const std::string modules = "modules_" + std::string(kind.name) + (number == 1 ? "" : "_" + std::to_string(number));
    bool is_free = true;
    std::vector<SourceFile> missing;
    for (const SourceFile& file : module_files(kind)) {
      const std::string name = name_of(folder / modules / std::filesystem::path(file.path).filename());
      const std::optional<std::string> present = change.read(name);
      if (!present) {
        missing.push_back({name, file.text});
      } else if (*present != file.text) {
        is_free = false;
      }
    }
    if (!is_free) {
      continue;
    }
    for (const SourceFile& file : missing) {
      change.add_file(file.path, file.text);
    }
    return modules;
  }
}

}  // namespace

void set_kind_of_links(DraftChange& change, const RobotKind& kind, std::optional<std::size_t> link) {
  Scenario scenario = change.scenario();
  const std::string file = scenario.robot_file;
  const std::size_t count = scenario.robot.links.size();
  if (link && *link >= count) {
    throw InputError("link", 0, std::to_string(*link), "a number below " + std::to_string(count));
  }
  const std::string folder = add_module_files(change, file, kind);
  const std::size_t first = link.value_or(0);
  for (std::size_t i = first; i < (link ? *link + 1 : count); ++i) {
    if (i > first) {
      scenario = change.scenario();
    }
    const ChainText chain = read_chain_text(change, scenario);
    for (const ChainText::Joint& joint : chain.joints) {
      if (joint.is_framed_by_rear) {
        throw InputError(file, change.xml(file).at(joint.element).tag.line,
                         "joint " + in_quotes(joint.name) + " in the frame of the link behind it",
                         "joints in the frame of the link in front, to exchange modules here");
      }
    }
    const ChainText::Link& old = chain.links[i];
    if (!change.xml(file).attribute(old.place, "file")) {
      throw InputError(file, change.xml(file).at(old.place).tag.line,
                       "link " + in_quotes(old.name) + ", whose <Body> stands in this file",
                       "a link with a file of its own, to exchange it here");
    }
    const Role& role = i == 0 ? tail_role : i + 1 == count ? head_role : segment_role;
    const std::string prefix = change.xml(file).attribute(old.place, "prefix").value_or("");
    const std::string name = prefix + std::string(role.body);
    if (i > 0 && i + 1 < count) {
      const Eigen::Vector3d length = length_of_link(scenario, i);
      const double new_length = static_cast<double>(kind.module_mm) / 1000.0;
      shift_links_in_front(change, scenario, chain, i, length.normalized() * new_length - length);
    }
    const ElementNumber place = find_robot_elements(change, scenario).links.at(old.name).place.value();
    change.apply(file, change.xml(file).set_attribute(place, "file", folder + "/" + std::string(role.file)));
    if (name != old.name) {
      replace_link_names(change, file, {{old.name, name}});
    }
  }
}

}  // namespace proleg::sim
