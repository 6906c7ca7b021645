#pragma once

// The subcommands of `proleg new`, the texts of new files (CMake makes strings of the program of them), and how
// they write files.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

// The files in algorithm_template/, which algorithm_files() fills in. Lines between `@if KEY@`, `@else@` and `@end@`
// depend on the form of the algorithm.
[[nodiscard]] std::string_view algorithm_source_text();
[[nodiscard]] std::string_view algorithm_test_text();        ///< of the example, against its equation
[[nodiscard]] std::string_view algorithm_plain_test_text();  ///< of any other
[[nodiscard]] std::string_view algorithm_cmake_text();
[[nodiscard]] std::string_view algorithm_actuation_text();
[[nodiscard]] std::string_view algorithm_readme_text();

// The files of a project beside its robot, in project_template/.
[[nodiscard]] std::string_view project_readme_text();  ///< NAME: of the folder
[[nodiscard]] std::string_view project_search_text();  ///< JOINTS: a 1 for each joint

/// proleg new project: writes a folder to work in. argv[0] is "project". Returns the exit status.
int new_project(int argc, char** argv);

/// proleg new algorithm: writes the folder of a user's algorithm. argv[0] is "algorithm". Returns the exit status.
int new_algorithm(int argc, char** argv);

/// proleg new obstacle: writes an environment file with hills. argv[0] is "obstacle". Returns the exit status.
int new_obstacle(int argc, char** argv);

/// Writes all files, whose paths are relative to the folder, and a line for each on standard output. Throws BadInput,
/// before it writes a file, if one of them exists; and InputError if the folder has no name.
void write_new_files(const std::filesystem::path& folder, std::span<const sim::SourceFile> files);

}  // namespace proleg::tools
