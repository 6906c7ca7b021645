#include "tools/proleg/ui/folder_walk.hpp"

#include <algorithm>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

namespace fs = std::filesystem;

bool is_inside(const fs::path& folder, const fs::path& path) {
  const auto [end, other] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end() && other != path.end();
}

fs::path find_inside(const fs::path& folder, const std::string& name, const char* argument,
                     const std::string& expected) {
  const fs::path path(name);
  const bool has_dots = std::ranges::find(path, fs::path("..")) != path.end();
  if (name.empty() || name.find('\0') != std::string::npos || path.is_absolute() || has_dots) {
    throw InputError(argument, 0, in_quotes(one_line(shortened(name))), expected);
  }
  std::error_code error;
  const fs::path real = fs::canonical(folder / path, error);
  if (error) {
    throw InputError(argument, 0, in_quotes(one_line(shortened(name))) + ": " + error.message(), expected);
  }
  if (!is_inside(folder, real)) {
    throw InputError(argument, 0, in_quotes(one_line(shortened(name))) + ", which leads out of the folder", expected);
  }
  return real;
}

}  // namespace proleg::tools
