#include "tests/identity/verify/user_builds.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/program_run.hpp"

namespace proleg::verify {
namespace {

namespace fs = std::filesystem;

/// The line that says most about why a build failed.
std::string first_error(const fs::path& log) {
  std::ifstream file(log);
  std::string last = "no output";
  bool takes_next = false;
  for (std::string line; std::getline(file, line);) {
    if (line.find("error: ") != std::string::npos || line.find("undefined reference") != std::string::npos) {
      return line;
    }
    if (takes_next && !trimmed(line).empty()) {
      return std::string(trimmed(line));
    }
    takes_next = takes_next || line.starts_with("CMake Error");
    if (!trimmed(line).empty()) {
      last = line;
    }
  }
  return last;
}

/// Why no file can be made in a folder, which is made if it is missing; empty: it can.
std::string why_unwritable(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && access(folder.c_str(), W_OK | X_OK) != 0) {
    error = std::error_code(errno, std::generic_category());
  }
  return error ? error.message() : "";
}

std::optional<fs::path> cache_folder() {
  for (const auto& [variable, below] : {std::pair("XDG_CACHE_HOME", ""), std::pair("HOME", ".cache")}) {
    const char* const value = std::getenv(variable);
    if (value != nullptr && fs::path(value).is_absolute()) {
      return fs::path(value) / below;
    }
  }
  return std::nullopt;
}

/// The sources of a build folder that CMake has configured; empty: it has not.
std::string configured_source(const fs::path& build) {
  constexpr std::string_view entry = "CMAKE_HOME_DIRECTORY:INTERNAL=";
  std::ifstream cache(build / "CMakeCache.txt");
  for (std::string line; std::getline(cache, line);) {
    if (line.starts_with(entry)) {
      return line.substr(entry.size());
    }
  }
  return "";
}

}  // namespace

UserBuilds::UserBuilds(fs::path tree, fs::path folder) : tree_(std::move(tree)), folder_(std::move(folder)) {
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& path = entry->path();
    if (path.extension() == ".cpp" && !path.stem().string().ends_with("_test")) {
      names.push_back(path.stem().string());
    }
  }
  if (error || names.size() != 1) {
    throw BuildError(folder_.string() + ": found " +
                     (error ? "no such folder" : std::to_string(names.size()) + " sources") +
                     ", expected a folder with one source, as 'proleg new algorithm' writes it");
  }
  name_ = names.front();
  place_ = choose_place();
}

fs::path UserBuilds::choose_place() const {
  const fs::path own = folder_ / "build/verify";
  const std::string problem = why_unwritable(own);
  if (problem.empty()) {
    return own;
  }
  const std::optional<fs::path> cache = cache_folder();
  if (!cache) {
    throw BuildError(own.string() + ": " + problem +
                     "; found neither XDG_CACHE_HOME nor HOME for another folder of builds");
  }
  const fs::path aside = *cache / "proleg/verify" / folder_.relative_path();
  if (const std::string other = why_unwritable(aside); !other.empty()) {
    throw BuildError("found no folder for builds: " + own.string() + ": " + problem + "; " + aside.string() + ": " +
                     other + "; set XDG_CACHE_HOME to a folder that you can write");
  }
  return aside;
}

bool UserBuilds::has_test() const { return fs::exists(folder_ / (name_ + "_test.cpp")); }

fs::path UserBuilds::build_folder(const std::string& what) const { return place_ / what; }

void UserBuilds::run(const std::string& what, const std::vector<std::string>& command) const {
  const fs::path log = place_ / (what + ".log");
  std::vector<std::string> words{"sh", "-c", "exec \"$@\" >\"$0\" 2>&1", log.string()};
  words.insert(words.end(), command.begin(), command.end());
  const tools::ProgramResult result = tools::run_program(words, tree_.string());
  if (result.status != 0) {
    throw BuildError(one_line((what == "test" ? "" : "the build for " + what + " fails: ") + first_error(log) +
                              "; all of it is in " + log.string()));
  }
}

void UserBuilds::configure(const std::string& what, const fs::path& source,
                           const std::vector<std::string>& options) const {
  const fs::path build = build_folder(what);
  // CMake refuses the build of other sources, such as those of a checkout after an installation.
  std::error_code ignored;
  if (const std::string before = configured_source(build);
      !before.empty() && !fs::equivalent(before, source, ignored)) {
    fs::remove_all(build, ignored);
  }
  std::vector<std::string> command{"cmake", "-S", source.string(), "-B", build.string()};
  command.insert(command.end(), options.begin(), options.end());
  run(what, command);
}

fs::path UserBuilds::library() const {
  const fs::path build = build_folder("library");
  configure("library", folder_,
            {"-G", "Ninja", "-DPROLEG_SOURCE=" + tree_.string(), "-DProleg_DIR=" + (tree_ / "tools/cmake").string(),
             "-DPROLEG_ALLOW_FLOATING_POINT=ON"});  // the proof itself finds it, on every processor
  run("library", {"cmake", "--build", build.string()});
  return build / (name_ + ".so");
}

void UserBuilds::run_test() const { run("test", {(build_folder("library") / (name_ + "_test")).string()}); }

fs::path UserBuilds::variants(const std::string& compiler) const {
  const fs::path build = build_folder(compiler);
  configure(compiler, tree_ / "tests/identity/user_variants",
            {"-G", "Ninja", "-DCMAKE_CXX_COMPILER=" + compiler, "-DPROLEG_USER_ALGORITHMS=" + folder_.string()});
  run(compiler, {"cmake", "--build", build.string()});
  return build;
}

void UserBuilds::configure_cortex_m(const std::string& preset) const {
  configure(preset, tree_, {"--preset", preset, "-DPROLEG_USER_ALGORITHMS=" + folder_.string()});
}

fs::path UserBuilds::cortex_m_object(const std::string& preset) const {
  configure_cortex_m(preset);
  run(preset, {"cmake", "--build", build_folder(preset).string(), "--target", "shared_gait"});
  std::error_code error;
  for (fs::recursive_directory_iterator entry(build_folder(preset) / "shared", error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().filename().string().starts_with(name_ + ".algorithm.cpp.o")) {
      return entry->path();
    }
  }
  throw BuildError("found no object file of " + name_ + " in " + build_folder(preset).string());
}

fs::path UserBuilds::cortex_m_image(const std::string& preset) const {
  configure_cortex_m(preset);
  run(preset, {"cmake", "--build", build_folder(preset).string(), "--target", "core_image"});
  return build_folder(preset) / "bin/core_image.elf";
}

}  // namespace proleg::verify
