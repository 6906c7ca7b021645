#include "tools/proleg/ui/algorithm_folders.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/new/algorithm_files.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_entries = 1000;
constexpr const char* this_folder = ".";

std::string bytes_of(const fs::path& path, std::size_t most) {
  std::ifstream file(path, std::ios::binary);
  std::string text(most + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return text;
}

/// The algorithm in a folder, if the folder is one of `proleg new algorithm`. Links are not followed.
std::optional<AlgorithmFolder> algorithm_in(const fs::path& path) {
  constexpr std::size_t most_cmake_bytes = 64 * 1024;
  std::error_code error;
  if (!fs::is_directory(fs::symlink_status(path, error)) ||
      !fs::is_regular_file(fs::symlink_status(path / "CMakeLists.txt", error)) ||
      bytes_of(path / "CMakeLists.txt", most_cmake_bytes).find("proleg_algorithm_project()") == std::string::npos) {
    return std::nullopt;
  }
  std::vector<fs::path> sources;
  std::size_t visited = 0;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end && ++visited < most_entries;
       entry.increment(error)) {
    if (entry->path().extension() == ".cpp" && !entry->path().stem().string().ends_with("_test") &&
        fs::is_regular_file(entry->symlink_status(error))) {
      sources.push_back(entry->path());
    }
  }
  if (sources.size() != 1) {
    return std::nullopt;
  }
  return AlgorithmFolder{path.filename().string(), sources.front().stem().string(), path, sources.front()};
}

}  // namespace

AlgorithmFolders::AlgorithmFolders(const fs::path& project) {
  std::error_code error;
  project_ = fs::canonical(project, error);
  if (error) {
    throw InputError(project.string(), 0, "no folder", "the folder of a project");
  }
}

std::vector<AlgorithmFolder> AlgorithmFolders::list() const {
  std::vector<AlgorithmFolder> found;
  if (std::optional<AlgorithmFolder> itself = algorithm_in(project_)) {
    itself->folder = this_folder;
    found.push_back(std::move(*itself));
  }
  std::error_code error;
  std::size_t visited = 0;
  for (fs::directory_iterator entry(project_, error), end;
       !error && entry != end && ++visited < most_entries && found.size() < most_folders; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!is_visible_line(name) || name.starts_with('.')) {
      continue;
    }
    if (std::optional<AlgorithmFolder> algorithm = algorithm_in(entry->path())) {
      found.push_back(std::move(*algorithm));
    }
  }
  std::ranges::sort(found, {}, &AlgorithmFolder::folder);
  return found;
}

std::optional<AlgorithmFolder> AlgorithmFolders::with_name(const std::string& name) const {
  std::vector<AlgorithmFolder> all = list();
  const auto found = std::ranges::find(all, name, &AlgorithmFolder::name);
  return found == all.end() ? std::nullopt : std::optional(std::move(*found));
}

AlgorithmFolder AlgorithmFolders::find(const std::string& folder) const {
  const fs::path name(folder);
  const bool is_plain = !folder.empty() && name.filename() == name && folder.front() != '.' && is_visible_line(folder);
  std::optional<AlgorithmFolder> found = is_plain ? algorithm_in(project_ / name) : std::nullopt;
  if (folder == this_folder) {
    found = algorithm_in(project_);
    if (found) {
      found->folder = this_folder;
    }
  }
  if (!found) {
    throw InputError("folder", 0, in_quotes(shortened(folder)),
                     "a folder of the project with one source, as 'proleg new algorithm' writes it");
  }
  return std::move(*found);
}

AlgorithmFolder AlgorithmFolders::create(const AlgorithmForm& form, const fs::path& source_tree) const {
  check_form(form);
  const fs::path folder = project_ / form.name;
  check_algorithm_folder(folder.string(), "name");
  for (const AlgorithmFolder& known : list()) {
    if (lower_case(known.name) == lower_case(form.name)) {
      throw InputError("name", 0, in_quotes(form.name) + ", the algorithm in the folder " + in_quotes(known.folder),
                       "another name");
    }
  }
  const std::vector<sim::SourceFile> files = algorithm_files(form, source_tree.string());
  std::error_code error;
  if (!fs::create_directory(folder, error)) {
    if (error) {
      throw FileError(folder, "cannot be created: " + error.message());
    }
    throw InputError("name", 0, in_quotes(form.name) + ", a folder that exists", "another name");
  }
  try {
    for (const sim::SourceFile& file : files) {
      fs::create_directories((folder / file.path).parent_path());
      write_file(folder / file.path, file.text);
    }
  } catch (...) {
    fs::remove_all(folder, error);
    throw;
  }
  return find(form.name);
}

SourceText AlgorithmFolders::read(const AlgorithmFolder& algorithm) {
  const std::string& file = algorithm.source.filename().string();
  std::string text = bytes_of(algorithm.source, most_source_bytes);
  if (text.size() > most_source_bytes) {
    throw InputError(file, 0, "a longer text", "at most " + std::to_string(most_source_bytes / 1024) + " KiB");
  }
  if (const auto invalid = find_invalid_utf8(text); invalid || text.find('\0') != std::string::npos) {
    throw InputError(file, 0, "bytes that are no text", "UTF-8");
  }
  std::string version = sha256_hex(text);
  return {std::move(text), std::move(version)};
}

std::string AlgorithmFolders::write(const AlgorithmFolder& algorithm, const std::string& text,
                                    const std::string& version) {
  const std::string& file = algorithm.source.filename().string();
  if (text.size() > most_source_bytes) {
    throw InputError(file, 0, std::to_string(text.size()) + " bytes",
                     "at most " + std::to_string(most_source_bytes / 1024) + " KiB");
  }
  const std::string new_version = sha256_hex(text);
  const std::string present = sha256_hex(bytes_of(algorithm.source, most_source_bytes));
  if (present == new_version) {
    return new_version;
  }
  if (present != version) {
    throw InputError(file, 0, "a file that has changed since it was read",
                     "the same file; copy what you have written, and open it again");
  }
  write_file(algorithm.source, text);
  return new_version;
}

}  // namespace proleg::tools
