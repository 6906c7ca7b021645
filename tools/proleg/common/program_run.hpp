#pragma once

#include <string>
#include <vector>

namespace proleg::tools {

/// An argument of a command that is printed for the user to repeat: in quotes for a shell, if it needs them.
[[nodiscard]] std::string shell_argument(const std::string& argument);

/// Text " --algorithms LIBRARY" for each library that this program has loaded, in their order; mostly empty. A command
/// that repeats or continues a run needs them.
[[nodiscard]] std::string algorithm_options();

/// Whether a shell would find the program.
[[nodiscard]] bool is_installed(const std::string& program);

/// The command that installs the Debian packages of programs which builds need.
[[nodiscard]] std::string installing_command(const std::vector<std::string>& programs);

struct ProgramResult {
  bool was_found = true;
  int status = 0;      ///< exit status, or 128 + the number of a signal, as a shell reports it
  std::string output;  ///< standard output and standard error, in the order of their arrival
};

/// Runs a program, without a shell and without input, in a folder, and waits for its end. Its output appears on
/// standard error meanwhile. command: the program, which is searched for as in a shell, and its arguments. Throws
/// std::runtime_error if the program exists but cannot be started.
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& command, const std::string& folder);

}  // namespace proleg::tools
