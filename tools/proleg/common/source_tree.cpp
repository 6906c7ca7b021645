#include "tools/proleg/common/source_tree.hpp"

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

}  // namespace proleg::tools
