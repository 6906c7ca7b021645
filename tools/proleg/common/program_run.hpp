#pragma once

#include <string>
#include <vector>

namespace proleg::tools {

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
