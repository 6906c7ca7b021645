#include "tools/proleg/ui/folder_walk.hpp"

#include <algorithm>
#include <set>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

namespace fs = std::filesystem;

bool is_inside(const fs::path& folder, const fs::path& path) {
  const auto [end, other] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end() && other != path.end();
}

std::vector<std::string> folders_with(const fs::path& folder, std::span<const char* const> files,
                                      std::span<const std::string> before) {
  std::set<std::string> found;
  const auto enters = [](const fs::path& path) { return !path.filename().string().starts_with('.'); };
  const auto is_wanted = [&](const fs::path& path) {
    return std::ranges::any_of(files, [&](const char* name) { return path.filename() == name; });
  };
  const auto note = [&](const fs::path& path) {
    std::error_code error;
    if (is_wanted(path) && fs::is_regular_file(path, error) && is_inside(folder, fs::canonical(path, error)) &&
        !error && path.parent_path() != folder && !find_invalid_utf8(path.string())) {
      found.insert(path.parent_path().lexically_relative(folder).string());
    }
  };
  if (!for_each_path(folder, note, enters)) {
    for (const std::string& name : before) {
      std::error_code error;
      if (std::ranges::any_of(files,
                              [&](const char* file) { return fs::is_regular_file(folder / name / file, error); })) {
        found.insert(name);
      }
    }
  }
  return {found.begin(), found.end()};
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
