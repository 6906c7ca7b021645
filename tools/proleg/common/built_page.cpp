#include "tools/proleg/common/built_page.hpp"

#include <system_error>

#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

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
