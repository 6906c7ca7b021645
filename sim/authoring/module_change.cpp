#include "sim/authoring/module_change.hpp"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/chain_text.hpp"
#include "sim/authoring/own_mesh.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

/// Adds those files of a kind to the draft that it does not have. Returns their folder, relative to that of the robot's
/// file.
std::string add_module_files(DraftChange& change, const std::filesystem::path& parent, const ModuleKind& kind) {
  if (!kind.folder) {
    return add_in_free_folder(change, parent, "modules_" + kind.name, kind.files);
  }
  for (const SourceFile& file : kind.files) {
    const std::string name = name_of(parent / *kind.folder / file.path);
    if (!change.read(name)) {
      change.add_file(name, file.text);
    }
  }
  return *kind.folder;
}

}  // namespace

void set_kind_of_links(DraftChange& change, const ModuleKind& kind, std::span<const std::size_t> links) {
  Scenario scenario = change.scenario();
  const std::string file = scenario.robot_file;
  const std::size_t count = scenario.robot.links.size();
  std::vector<std::size_t> chosen(links.begin(), links.end());
  if (chosen.empty()) {
    chosen.resize(count);
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  }
  const std::string folder = add_module_files(change, std::filesystem::path(file).parent_path(), kind);
  bool is_first = true;
  for (const std::size_t i : chosen) {
    if (i >= count) {
      throw InputError("link", 0, std::to_string(i), "a number below " + std::to_string(count));
    }
    if (!std::exchange(is_first, false)) {
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
    const ModuleRole& role = i == 0 ? tail_role : i + 1 == count ? head_role : segment_role;
    const std::string prefix = change.xml(file).attribute(old.place, "prefix").value_or("");
    const std::string name = prefix + std::string(role.body);
    if (i > 0 && i + 1 < count) {
      const Eigen::Vector3d length = length_of_link(scenario, i);
      shift_links_in_front(change, scenario, chain, i, length.normalized() * kind.length - length);
    }
    const ElementNumber place = find_robot_elements(change, scenario).links.at(old.name).place.value();
    change.apply(file, change.xml(file).set_attribute(place, "file", folder + "/" + std::string(role.file)));
    if (name != old.name) {
      replace_link_names(change, file, {{old.name, name}});
    }
  }
}

}  // namespace proleg::sim
