#include "tools/proleg/command_line.hpp"

#include <exception>
#include <iostream>

#include "sim/scenario/input_error.hpp"
#include "sim/scenario/text.hpp"

namespace proleg::tools {

int run_command(int argc, char** argv, CLI::App& app, const std::function<int()>& body) {
  const auto complain = [&](const std::exception& error) {
    std::cerr << app.get_name() << ": " << sim::one_line(error.what()) << '\n';
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help
    app.exit(request);
    return exit_success;
  } catch (const CLI::ParseError& error) {
    std::cerr << app.get_name() << ": found " << sim::one_line(error.what()) << ", expected what '" << app.get_name()
              << " --help' lists\n";
    return exit_bad_input;
  }
  try {
    return body();
  } catch (const sim::InputError& error) {
    complain(error);
    return exit_bad_input;
  } catch (const std::exception& error) {
    complain(error);
    return exit_failed;
  }
}

}  // namespace proleg::tools
