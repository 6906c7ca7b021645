#include "tools/proleg/common/program_places.hpp"

#include <system_error>

#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

bool is_source_tree(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::exists(folder / "tools/cmake/user_algorithm.cmake", error) &&
         std::filesystem::exists(folder / "shared/gait/registry.cpp", error);
}

}  // namespace

std::filesystem::path source_tree(const std::string& given) {
  if (!given.empty()) {
    const std::filesystem::path folder = std::filesystem::absolute(given).lexically_normal();
    if (!is_source_tree(folder)) {
      throw BadInput("--source: found " + folder.string() + " without the sources of Proleg, expected a checkout");
    }
    return folder;
  }
  // A program is in build/PRESET/bin of its checkout.
  std::error_code error;
  std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  while (!folder.empty() && !is_source_tree(folder)) {
    if (folder == folder.parent_path()) {
      throw BadInput("found no checkout of Proleg around this program, expected one; --source FOLDER names it");
    }
    folder = folder.parent_path();
  }
  return folder;
}

std::filesystem::path built_page(const std::string& folder, const std::string& file) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path path = (self.parent_path() / "../.." / folder).lexically_normal();
  if (!std::filesystem::exists(path / file, error)) {
    throw BadInput("found no " + folder + " in " + path.string() + ", expected one that tools/page has built");
  }
  return path;
}

}  // namespace proleg::tools
