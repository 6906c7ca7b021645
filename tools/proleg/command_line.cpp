#include "tools/proleg/command_line.hpp"

#include <exception>
#include <iostream>
#include <string>

#include "sim/scenario/input_error.hpp"
#include "sim/scenario/text.hpp"

namespace proleg::tools {

namespace {

/// What a command line that cannot be parsed contains, or lacks.
std::string found(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    std::string words;
    for (const std::string& word : app.remaining()) {
      words += (words.empty() ? "" : " ") + sim::in_quotes(word);
    }
    return "unknown " + words;
  }
  const std::string text = error.what();
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    return "no " + text.substr(0, text.find(' '));
  }
  return text;
}

}  // namespace

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
    std::cerr << app.get_name() << ": found " << sim::one_line(found(app, error)) << ", expected what '"
              << app.get_name() << " --help' lists\n";
    return exit_bad_input;
  }
  try {
    const int status = body();
    std::cout.flush();
    if (!std::cout) {
      throw std::runtime_error("cannot write to standard output");
    }
    return status;
  } catch (const sim::InputError& error) {
    complain(error);
    return exit_bad_input;
  } catch (const BadInput& error) {
    complain(error);
    return exit_bad_input;
  } catch (const std::exception& error) {
    complain(error);
    return exit_failed;
  }
}

}  // namespace proleg::tools
