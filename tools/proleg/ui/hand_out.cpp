#include "tools/proleg/ui/hand_out.hpp"

#include <string_view>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "sim/authoring/part_change.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/ui/project_files.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

std::string scenario_title(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t extension = std::string_view(scenario_extension).size();
  return name.ends_with(scenario_extension) && name.size() > extension ? name.substr(0, name.size() - extension)
                                                                       : file.stem().string();
}

}  // namespace

HandOut::HandOut(const fs::path& file) : title_(scenario_title(file)) {
  sim::DiskFiles disk;
  sim::Scenario scenario = sim::read_scenario(file, disk);
  sources_ = std::move(scenario.sources);
  place_ = sim::absolute_path(sources_.front().path).lexically_relative(sim::common_folder(sources_));
}

fs::path HandOut::copy_to(const fs::path& folder) const {
  std::string name = title_;
  std::error_code error;
  for (int number = 2; fs::exists(fs::symlink_status(folder / name, error)); ++number) {
    name = title_ + " " + std::to_string(number);
  }
  static_cast<void>(copy_sources(sources_, folder / name));
  return fs::path(name) / place_;
}

fs::path HandOut::copy_once_to(const fs::path& folder) const {
  std::error_code error;
  const fs::path known = fs::path(title_) / place_;
  return fs::is_regular_file(folder / known, error) ? known : copy_to(folder);
}

}  // namespace proleg::tools
