#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace proleg::tools {

/// Exit statuses of every program.
inline constexpr int exit_success = 0;
inline constexpr int exit_failed = 1;     ///< the run failed
inline constexpr int exit_bad_input = 2;  ///< nothing was started

/// Parses the command line and runs the body. What goes wrong becomes one line on standard error:
/// a bad command line or an InputError gives status 2, any other exception status 1. --help gives 0.
int run_command(int argc, char** argv, CLI::App& app, const std::function<int()>& body);

}  // namespace proleg::tools
