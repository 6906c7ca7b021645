#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <stdexcept>

namespace proleg::tools {

/// Exit statuses of every program.
inline constexpr int exit_success = 0;
inline constexpr int exit_failed = 1;     ///< the run failed
inline constexpr int exit_bad_input = 2;  ///< nothing was started

/// What a user gave cannot be used; what() is the whole message. For what is found before anything was started and is
/// not an InputError already.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Parses the command line and runs the body. What goes wrong becomes one line on standard error:
/// a bad command line, an InputError or a BadInput gives status 2, any other exception status 1. --help gives 0.
int run_command(int argc, char** argv, CLI::App& app, const std::function<int()>& body);

}  // namespace proleg::tools
