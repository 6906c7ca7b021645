#include "sim/authoring/part_change.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "sim/authoring/scenario_text.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> part_tags{"robot", "actuation", "environment"};

std::size_t position_of(const Scenario& scenario, const std::string& file) {
  return static_cast<std::size_t>(std::ranges::find(scenario.sources, file, &SourceFile::path) -
                                  scenario.sources.begin());
}

/// The file of a part, and those that it names: the reader reads one part after the other.
std::vector<SourceFile> files_of(const Scenario& scenario, ScenarioPart part) {
  const std::size_t robot = position_of(scenario, scenario.robot_file);
  const std::size_t actuation = position_of(scenario, scenario.actuation_file);
  const std::size_t environment = position_of(scenario, scenario.environment_file);
  const std::array<std::size_t, 4> begins{robot, actuation, environment, scenario.sources.size()};
  const auto number = static_cast<std::size_t>(part);
  const auto at = [&](std::size_t position) {
    return scenario.sources.begin() + static_cast<std::ptrdiff_t>(position);
  };
  return {at(begins.at(number)), at(begins.at(number + 1))};
}

}  // namespace

std::string_view tag_of(ScenarioPart part) { return part_tags.at(static_cast<std::size_t>(part)); }

std::optional<ScenarioPart> part_named(std::string_view tag) {
  const auto found = std::ranges::find(part_tags, tag);
  return found == part_tags.end() ? std::nullopt : std::optional(static_cast<ScenarioPart>(found - part_tags.begin()));
}

void take_part(DraftChange& change, const Scenario& scenario, const Scenario& other, ScenarioPart part) {
  const std::vector<SourceFile> files = files_of(other, part);
  const fs::path root = common_folder(files);
  const std::string top = name_of(scenario.path);
  const fs::path folder = fs::path(top).parent_path();
  const std::string other_name = fs::path(other.path).filename().string();
  const std::string stem = other_name.substr(0, other_name.find('.'));
  for (unsigned number = 0;; ++number) {
    const fs::path inside =
        number == 0 ? fs::path() : fs::path(stem + (number == 1 ? "" : "_" + std::to_string(number)));
    std::vector<SourceFile> missing;
    const bool is_free = std::ranges::all_of(files, [&](const SourceFile& file) {
      const std::string name = name_of(folder / inside / absolute_path(file.path).lexically_relative(root));
      const std::optional<std::string> present = change.read(name);
      if (!present) {
        missing.push_back({name, file.text});
      }
      return !present || *present == file.text;
    });
    if (!is_free) {
      continue;
    }
    for (const SourceFile& file : missing) {
      change.add_file(file.path, file.text);
    }
    set_tag(change, top, 0, tag_of(part),
            (inside / absolute_path(files.front().path).lexically_relative(root)).generic_string());
    return;
  }
}

fs::path absolute_path(const fs::path& path) { return fs::absolute(path).lexically_normal(); }

fs::path common_folder(std::span<const SourceFile> files) {
  fs::path common = absolute_path(files.front().path).parent_path();
  for (const SourceFile& file : files) {
    const fs::path path = absolute_path(file.path);
    while (path.lexically_relative(common).begin()->string() == "..") {
      common = common.parent_path();
    }
  }
  return common;
}

}  // namespace proleg::sim
