#include "shared/computer/algorithm_library/algorithm_library.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <optional>
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

/// Loads a library in this process.
std::unique_ptr<const GuardedAlgorithm> load(const std::string& path) {
  // The loader would search its folders for a name without a folder.
  const std::string absolute = std::filesystem::absolute(path).string();
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
void try_to_load(const std::string& path) {
  const Trial trial = try_in_child([&]() -> std::string {
    try {
      static_cast<void>(load(path));
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

std::vector<std::unique_ptr<const GuardedAlgorithm>>& loaded_algorithms() {
  static auto& owned = *new std::vector<std::unique_ptr<const GuardedAlgorithm>>;
  return owned;  // it is never destroyed, because kernels name the algorithms until the end
}

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
  if (const std::optional<std::string> found = found_instead_of_file(path)) {
    throw InputError(path.empty() ? in_quotes(path) : path, 0, *found,
                     "the library of an algorithm, as 'proleg new algorithm' makes it");
  }
  try_to_load(path);
  return load(path);
}

std::vector<std::string> loaded_libraries() {
  std::vector<std::string> files;
  for (const auto& algorithm : loaded_algorithms()) {
    files.push_back(algorithm->file());
  }
  return files;
}

void load_algorithms(std::span<const std::string> paths) {
  static std::vector<const ActuationModule*>& registered = *new std::vector<const ActuationModule*>;
  set_ending_signals([] {});
  for (const std::string& path : paths) {
    std::unique_ptr<const GuardedAlgorithm> algorithm = load_algorithm(path);
    const Declaration& declaration = algorithm->declaration();
    const ActuationModule* same = find_algorithm(declaration.name);
    same = same == nullptr ? find_algorithm(declaration.id) : same;
    if (same != nullptr) {
      throw InputError(path, 0,
                       "the algorithm " + in_quotes(declaration.name) + " with id " + std::to_string(declaration.id),
                       "another name and id than those of " + in_quotes(same->declaration().name) + ", which has " +
                           std::to_string(same->declaration().id));
    }
    blame_for_crashes(algorithm->file().c_str());
    registered.push_back(algorithm.get());
    loaded_algorithms().push_back(std::move(algorithm));
    set_loaded_algorithms(registered);
  }
}

}  // namespace proleg
