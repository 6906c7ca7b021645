#include "tools/proleg/common/installation.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// The checkout or the prefix.
fs::path top() { return program_folder().parent_path().parent_path().parent_path(); }

/// share/proleg of an installation; nothing in a checkout.
std::optional<fs::path> installed_data() {
  std::error_code error;
  fs::path data = top() / "share/proleg";
  return !is_source_tree(top()) && fs::is_directory(data, error) ? std::optional(std::move(data)) : std::nullopt;
}

/// The sources of an installation, with the build id that was written beside them.
fs::path installed_sources() {
  fs::path sources = top() / "src/proleg";
  if (!is_source_tree(sources)) {
    throw BadInput("found no sources of Proleg in " + sources.string() +
                   ", expected those of the package proleg-dev: sudo apt install proleg-dev");
  }
  std::ifstream file(sources / "build_id_text.hpp");
  std::string line;
  std::getline(file, line);
  const std::string found = line.substr(std::min(line.find('"'), line.size()));
  if (found != '"' + std::string(build_id) + '"') {
    throw BadInput("found the sources of Proleg " + (found.empty() ? "without a version" : found) + " in " +
                   sources.string() + ", expected those of this program, \"" + build_id +
                   "\"; install proleg and proleg-dev of one version");
  }
  return sources;
}

bool is_below(const fs::path& file, const fs::path& folder) {
  const fs::path way = file.lexically_relative(folder);
  return !way.empty() && *way.begin() != "..";
}

}  // namespace

fs::path program_folder() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

bool is_program_replaced() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).string().ends_with(" (deleted)");  // proc(5)
}

bool is_source_tree(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "tools/cmake/user_algorithm.cmake", error) &&
         fs::exists(folder / "shared/gait/registry.cpp", error);
}

fs::path source_tree(const std::string& given) {
  if (!given.empty()) {
    const fs::path folder = fs::absolute(given).lexically_normal();
    if (!is_source_tree(folder)) {
      throw BadInput("--source: found " + folder.string() + " without the sources of Proleg, expected a checkout");
    }
    return folder;
  }
  if (installed_data()) {
    return installed_sources();
  }
  // A program is in build/PRESET/bin of its checkout.
  fs::path folder = program_folder();
  while (!folder.empty() && !is_source_tree(folder)) {
    if (folder == folder.parent_path()) {
      throw BadInput("found no checkout of Proleg around this program, expected one; --source FOLDER names it");
    }
    folder = folder.parent_path();
  }
  return folder;
}

std::optional<fs::path> shipped_folder() {
  if (const auto data = installed_data()) {
    return *data / "scenarios";
  }
  try {
    return source_tree("") / "sim/scenarios";
  } catch (const BadInput&) {
    return std::nullopt;
  }
}

bool is_shipped(const fs::path& file) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(file, error);
  if (const auto data = installed_data(); data && is_below(real, fs::weakly_canonical(*data, error))) {
    return true;
  }
  for (fs::path folder = real.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    if (folder.filename() == "scenarios" && folder.parent_path().filename() == "sim" &&
        is_source_tree(folder.parent_path().parent_path())) {
      return true;
    }
  }
  return false;
}

fs::path folder_of_page(const std::string& folder, const std::string& file) {
  std::error_code error;
  const std::optional<fs::path> data = installed_data();
  const fs::path path = data ? *data / folder : (program_folder() / "../.." / folder).lexically_normal();
  if (!fs::exists(path / file, error)) {
    throw BadInput("found no " + folder + " in " + path.string() +
                   (data ? ", expected the one that is installed with this program; install Proleg again"
                         : ", expected one that tools/page has built"));
  }
  return path;
}

std::optional<fs::path> documentation_folder() {
  std::error_code error;
  fs::path folder =
      installed_data() ? top() / "share/doc/proleg/html" : program_folder().parent_path().parent_path() / "docs/site";
  return fs::exists(folder / "index.html", error) ? std::optional(std::move(folder)) : std::nullopt;
}

fs::path image_folder() {
  const std::optional<fs::path> data = installed_data();
  return data ? *data / "images" : program_folder().parent_path().parent_path() / "stm32f405/bin";
}

}  // namespace proleg::tools
