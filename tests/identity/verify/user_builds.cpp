#include "tests/identity/verify/user_builds.hpp"

#include <algorithm>
#include <fstream>
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
}

bool UserBuilds::has_test() const { return fs::exists(folder_ / (name_ + "_test.cpp")); }

fs::path UserBuilds::build_folder(const std::string& what) const { return folder_ / "build/verify" / what; }

void UserBuilds::run(const std::string& what, const std::vector<std::string>& command) const {
  const fs::path log = folder_ / "build/verify" / (what + ".log");
  std::error_code error;
  fs::create_directories(log.parent_path(), error);
  std::vector<std::string> words{"sh", "-c", "exec \"$@\" >\"$0\" 2>&1", log.string()};
  words.insert(words.end(), command.begin(), command.end());
  const tools::ProgramResult result = tools::run_program(words, tree_.string());
  if (result.status != 0) {
    throw BuildError(one_line((what == "test" ? "" : "the build for " + what + " fails: ") + first_error(log) +
                              "; all of it is in " + log.string()));
  }
}

fs::path UserBuilds::library() const {
  const fs::path build = build_folder("library");
  run("library",
      {"cmake", "-S", folder_.string(), "-B", build.string(), "-G", "Ninja", "-DPROLEG_SOURCE=" + tree_.string(),
       "-DPROLEG_ALLOW_FLOATING_POINT=ON"});  // the proof itself finds it, on every processor
  run("library", {"cmake", "--build", build.string()});
  return build / (name_ + ".so");
}

void UserBuilds::run_test() const { run("test", {(build_folder("library") / (name_ + "_test")).string()}); }

fs::path UserBuilds::variants(const std::string& compiler) const {
  const fs::path build = build_folder(compiler);
  run(compiler, {"cmake", "-S", (tree_ / "tests/identity/user_variants").string(), "-B", build.string(), "-G", "Ninja",
                 "-DCMAKE_CXX_COMPILER=" + compiler, "-DPROLEG_USER_ALGORITHMS=" + folder_.string()});
  run(compiler, {"cmake", "--build", build.string()});
  return build;
}

void UserBuilds::configure_cortex_m(const std::string& preset) const {
  run(preset, {"cmake", "--preset", preset, "-B", build_folder(preset).string(),
               "-DPROLEG_USER_ALGORITHMS=" + folder_.string()});
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
