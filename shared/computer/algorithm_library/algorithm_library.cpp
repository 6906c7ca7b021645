#include "shared/computer/algorithm_library/algorithm_library.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "shared/computer/algorithm_library/guarded_call.hpp"
#include "shared/computer/algorithm_library/kept_signals.hpp"
#include "shared/computer/algorithm_library/program_end.hpp"
#include "shared/computer/child_process/trial.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"

namespace proleg {
namespace {

constexpr const char* compile_again = "; compile the library again with this checkout of Proleg";

/// The reason why dlopen() failed, without the path, which is in the message already.
std::string loader_error(const std::string& path) {
  const char* const text = dlerror();
  std::string error = text == nullptr ? "unknown reason" : text;
  if (error.starts_with(path + ": ")) {
    error.erase(0, path.size() + 2);
  }
  return error;
}

void check(const AlgorithmInterface& interface, const std::string& file) {
  if (interface.mark != AlgorithmInterface{.sources = 0, .layout = {}, .algorithm = nullptr}.mark) {
    throw InputError(file, 0, std::string("another object with the name ") + algorithm_interface_symbol,
                     std::string("the interface of an algorithm") + compile_again);
  }
  if (interface.version != algorithm_interface_version) {
    throw InputError(file, 0, "version " + std::to_string(interface.version) + " of the interface of algorithms",
                     "version " + std::to_string(algorithm_interface_version) + compile_again);
  }
  if (interface.size != sizeof(AlgorithmInterface)) {
    throw InputError(file, 0, "an interface of " + std::to_string(interface.size) + " bytes",
                     std::to_string(sizeof(AlgorithmInterface)) + compile_again);
  }
  for (std::size_t i = 0; i < algorithm_layout.size(); ++i) {
    if (interface.layout[i] != algorithm_layout[i].value) {
      throw InputError(file, 0, std::to_string(interface.layout[i]) + " " + algorithm_layout[i].name,
                       std::to_string(algorithm_layout[i].value) + compile_again);
    }
  }
  if (interface.core != core_fingerprint) {
    throw InputError(file, 0, "a library for the core " + hexadecimal(interface.core, 8),
                     "one for the core " + hexadecimal(core_fingerprint, 8) + compile_again);
  }
  if (interface.algorithm == nullptr || interface.sources == 0) {
    throw InputError(file, 0, "an interface without an algorithm or its sources", std::string("both") + compile_again);
  }
}

/// Runs a function of the library to which no tick belongs.
template <typename Function>
void ask(const std::string& file, const char* name, const char* what, const Function& function) {
  CallFailure failure;
  auto keep_signals = [&] {
    const SignalState before;
    function();
    before.restore();
  };
  if (!run_guarded({file.c_str(), name}, keep_signals, failure)) {
    throw InputError(file, 0, "a library that, " + std::string(what) + ", " + failure.text, "one that can be loaded");
  }
}

/// Loads a library in this process. path: for messages, and of the algorithm. file: that is opened.
std::unique_ptr<const GuardedAlgorithm> load(const std::string& path, const std::string& file) {
  // The loader would search its folders for a name without a folder.
  const std::string absolute = std::filesystem::absolute(file).string();
  void* library = nullptr;
  ask(path, "dlopen", "while it is loaded", [&] { library = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL); });
  if (library == nullptr) {
    throw InputError(path, 0, "no library that can be loaded (" + loader_error(absolute) + ")",
                     "a shared library for this computer");
  }
  const void* const interface = dlsym(library, algorithm_interface_symbol);
  if (interface == nullptr) {
    throw InputError(path, 0, std::string("no object ") + algorithm_interface_symbol,
                     "that of an algorithm; is this another library?");
  }
  return make_algorithm(*static_cast<const AlgorithmInterface*>(interface), path);
}

/// The guard of a call does not hold for the loader itself: a damaged library ends the program inside of it.
void try_to_load(const std::string& path, const std::string& file) {
  const Trial trial = try_in_child([&]() -> std::string {
    try {
      static_cast<void>(load(path, file));
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  });
  if (!trial.has_returned) {
    throw InputError(path, 0, "a library that, while it is loaded, " + trial.text,
                     std::string("one that can be loaded") + compile_again);
  }
  if (!trial.text.empty()) {
    throw InputError(trial.text);
  }
}

void require_library(const std::string& path) {
  if (const std::optional<std::string> found = found_instead_of_file(path)) {
    throw InputError(path.empty() ? in_quotes(path) : path, 0, *found,
                     "the library of an algorithm, as 'proleg new algorithm' makes it");
  }
}

/// A copy of a library beside it, under a name that was never loaded: the loader takes a library that it knows by its
/// name or its file for the same one. The file goes with this object; what is loaded stays.
class UnknownCopy {
 public:
  explicit UnknownCopy(const std::filesystem::path& library) : path_(library.string() + ".XXXXXX") {
    const int file = mkstemp(path_.data());
    if (file < 0) {
      throw FileError(library,
                      std::string("cannot be copied beside itself: ") + std::generic_category().message(errno));
    }
    close(file);
    std::error_code error;
    std::filesystem::copy_file(library, path_, std::filesystem::copy_options::overwrite_existing, error);
    if (error) {
      unlink(path_.c_str());
      throw FileError(library, "cannot be copied beside itself: " + error.message());
    }
  }
  ~UnknownCopy() { unlink(path_.c_str()); }
  UnknownCopy(const UnknownCopy&) = delete;
  UnknownCopy& operator=(const UnknownCopy&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The libraries of the program. It is never destroyed, because kernels name the algorithms until the end.
class Libraries {
 public:
  static Libraries& instance() {
    static auto& libraries = *new Libraries;
    return libraries;
  }

  /// Adds an algorithm to the registry. replaces: one with the same path may be there. Throws InputError.
  const ActuationModule& add(std::unique_ptr<const GuardedAlgorithm> algorithm, bool replaces) {
    const std::lock_guard lock(mutex_);
    const GuardedAlgorithm& added = *algorithm;
    std::size_t place = present_.size();
    for (std::size_t i = 0; replaces && i < present_.size(); ++i) {
      if (is_same_file(present_[i]->file(), added.file())) {
        place = i;
      }
    }
    require_free(added, place < present_.size() ? present_[place] : nullptr);
    if (place == present_.size()) {
      present_.push_back(&added);
    } else {
      present_[place] = &added;
    }
    blame_for_crashes(added.file().c_str());
    all_.push_back(std::move(algorithm));
    publish();
    return added;
  }

  [[nodiscard]] std::vector<std::string> files() {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> files;
    for (const GuardedAlgorithm* const algorithm : present_) {
      files.push_back(algorithm->file());
    }
    return files;
  }

 private:
  static bool is_same_file(const std::string& a, const std::string& b) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(a, ignored) == std::filesystem::weakly_canonical(b, ignored);
  }

  /// earlier: the version that is replaced, whose name and id are free.
  static void require_free(const GuardedAlgorithm& algorithm, const ActuationModule* earlier) {
    const Declaration& declaration = algorithm.declaration();
    for (const ActuationModule* const same : {find_algorithm(declaration.name), find_algorithm(declaration.id)}) {
      if (same != nullptr && same != earlier) {
        throw InputError(algorithm.file(), 0,
                         "the algorithm " + in_quotes(declaration.name) + " with id " + std::to_string(declaration.id),
                         "another name and id than those of " + in_quotes(same->declaration().name) + ", which has " +
                             std::to_string(same->declaration().id));
      }
    }
  }

  /// A list for the registry. Another thread may still read an earlier one, so that none is changed or freed.
  struct Published {
    explicit Published(const std::vector<const GuardedAlgorithm*>& present)
        : modules(present.begin(), present.end()), list(modules) {}
    std::vector<const ActuationModule*> modules;
    LoadedAlgorithms list;
  };
  void publish() {
    published_.push_back(std::make_unique<const Published>(present_));
    set_loaded_algorithms(&published_.back()->list);
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<const GuardedAlgorithm>> all_;  ///< earlier versions, too
  std::vector<const GuardedAlgorithm*> present_;              ///< in the registry
  std::vector<std::unique_ptr<const Published>> published_;
};

}  // namespace

std::unique_ptr<const GuardedAlgorithm> make_algorithm(const AlgorithmInterface& interface, const std::string& file) {
  check(interface, file);
  const ActuationModule* foreign = nullptr;
  Senses senses;
  const auto captured = std::make_unique<CapturedDeclaration>();
  ask(file, "declaration", "asked for its declaration", [&] {
    foreign = &interface.algorithm();
    captured->capture(foreign->declaration());
    senses = {foreign->senses_contacts(), foreign->senses_readings()};
  });
  if (captured->sources != interface.sources) {
    throw InputError(file, 0, "sources " + hexadecimal(captured->sources, 8) + " in the declaration of the algorithm",
                     "PROLEG_ALGORITHM_SOURCES, which is " + hexadecimal(interface.sources, 8));
  }
  return std::make_unique<const GuardedAlgorithm>(file, *foreign, *captured, senses);
}

std::unique_ptr<const GuardedAlgorithm> load_algorithm(const std::string& path) {
  require_library(path);
  try_to_load(path, path);
  return load(path, path);
}

std::vector<std::string> loaded_libraries() { return Libraries::instance().files(); }

void load_algorithms(std::span<const std::string> paths) {
  set_ending_signals([] {});
  for (const std::string& path : paths) {
    static_cast<void>(Libraries::instance().add(load_algorithm(path), false));
  }
}

const ActuationModule& load_algorithm_again(const std::string& path) {
  require_library(path);
  const UnknownCopy copy(path);
  try_to_load(path, copy.path());
  return Libraries::instance().add(load(path, copy.path()), true);
}

}  // namespace proleg
