#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/computer/algorithm_library/algorithm_interface.hpp"
#include "shared/computer/algorithm_library/guarded_algorithm.hpp"

namespace proleg {

/// Loads a library and checks it, in a child first: a damaged library can end the program that loads it. No function of
/// it is called before its interface has been read; the code that a library runs when it is loaded is guarded, too. The
/// library stays loaded until the program ends. Throws InputError if the file is missing, is no library for this
/// computer, has no interface or one of another version, core or layout, has a wrong declaration, or fails during these
/// calls.
[[nodiscard]] std::unique_ptr<const GuardedAlgorithm> load_algorithm(const std::string& path);

/// Checks an interface and makes its algorithm. file: for messages. Throws InputError.
[[nodiscard]] std::unique_ptr<const GuardedAlgorithm> make_algorithm(const AlgorithmInterface& interface,
                                                                     const std::string& file);

/// Loads libraries and adds their algorithms to the registry (shared/gait/registry.hpp), for the rest of the program.
/// Call it once, before other threads start. Throws InputError, also if two algorithms have the same name or id.
void load_algorithms(std::span<const std::string> paths);

/// Loads a library while the program runs, and adds its algorithm to the registry; if the library with this path was
/// loaded before, the new algorithm takes the place of the earlier one. What uses the earlier one goes on with it: it
/// stays loaded until the program ends. Any thread may call it. Needs the right to write into the library's folder.
/// Throws as load_algorithms() does, and FileError, and then changes nothing.
const ActuationModule& load_algorithm_again(const std::string& path);

/// The paths of the libraries whose algorithms are in the registry, in the order in which they were loaded first.
[[nodiscard]] std::vector<std::string> loaded_libraries();

}  // namespace proleg
