#pragma once

#include <string>
#include <vector>

namespace proleg::tools {

struct ProgramResult {
  bool was_found = true;
  int status = 0;      ///< as a shell reports it: 128 + the number of a signal
  std::string output;  ///< standard output and standard error, as they came
};

/// Runs a program, without a shell and without input, in a folder, and waits for its end. What it prints appears on
/// standard error meanwhile. command: the program, which is looked for as a shell does it, and its arguments. Throws
/// std::runtime_error if the program exists but cannot be started.
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& command, const std::string& folder);

}  // namespace proleg::tools
