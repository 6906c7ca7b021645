#include "tools/proleg/common/command_line.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <thread>
#include <utility>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/algorithm_library/kept_signals.hpp"
#include "shared/computer/algorithm_library/program_end.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

/// The fault of a command line that cannot be parsed.
struct ParseFailure {
  std::string found;
  std::string expected;
};

ParseFailure describe(const CLI::App& app, const CLI::ParseError& error) {
  const std::string usage = "the options and arguments that '" + app.get_name() + " --help' lists";
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    std::string arguments;
    for (const std::string& argument : app.remaining()) {
      arguments += (arguments.empty() ? "" : " ") + in_quotes(argument);
    }
    return {"unknown " + arguments, usage};
  }
  // The errors of CLI11 have the name of the option only as a part of their text.
  const std::string text = error.what();
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    return {"no " + text.substr(0, text.find(' ')), usage};
  }
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) {
    const std::size_t name = text.find(": ");
    const std::size_t value = text.find(" = ", name);
    if (value != std::string::npos) {
      return {text.substr(name + 2, value - name - 2) + ' ' + in_quotes(text.substr(value + 3)), "a number"};
    }
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const std::string name = text.substr(0, text.find(": "));
    if (text.find(": At Most 1 required") != std::string::npos) {
      return {name + ' ' + text.substr(text.rfind(' ') + 1) + " times", "it at most once"};
    }
    if (text.ends_with(" missing")) {
      return {"no value of " + name, usage};
    }
  }
  return {text, usage};
}

/// Text "; did you mean --record?" for an unknown option that is similar to a known one.
std::string hint(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) {
    return "";
  }
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      known.push_back(name);
    }
  }
  for (const std::string& argument : app.remaining()) {
    if (!argument.starts_with("--")) {
      continue;
    }
    if (const auto name = most_similar(std::string_view(argument).substr(2, argument.find('=') - 2), known)) {
      return "; did you mean --" + *name + "?";
    }
  }
  return "";
}

/// Opens standard streams that the caller closed, with a mode in which they cannot be used. Otherwise the next file, or
/// the socket of a worker, would get the number of the stream and its output.
void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) == -1 && errno == EBADF) {
      // open() returns the lowest free number, which is this one. (If it fails, the rest of the program fails too.)
      static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
    }
  }
}

std::atomic<bool> interrupt_flag = false;  // it is lock-free, so a signal handler may set it

}  // namespace

void print_warning(const std::string& program, const std::string& text) {
  std::cerr << program << ": warning: " << one_line(text) << '\n';
}

CommandLine::Option& CommandLine::Option::required() {
  option_->required();
  return *this;
}

CommandLine::Option& CommandLine::Option::value_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

CommandLine::Option& CommandLine::Option::excludes(const std::string& other) {
  option_->excludes(other);
  return *this;
}

CommandLine::Option& CommandLine::Option::shows_default() {
  option_->capture_default_str();
  return *this;
}

CommandLine::CommandLine(const std::string& name, const std::string& help)
    : app_(std::make_unique<CLI::App>(help, name)) {}

CommandLine::~CommandLine() = default;

CommandLine::Option CommandLine::add_option(const std::string& name, std::string& variable, const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

CommandLine::Option CommandLine::add_option(const std::string& name, std::optional<std::string>& variable,
                                            const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

CommandLine::Option CommandLine::add_option(const std::string& name, std::optional<double>& variable,
                                            const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

CommandLine::Option CommandLine::add_option(const std::string& name, std::vector<std::string>& variable,
                                            const std::string& help) {
  return Option(app_->add_option(name, variable, help)->allow_extra_args(false));
}

CommandLine::Option CommandLine::add_flag(const std::string& name, bool& variable, const std::string& help) {
  return Option(app_->add_flag(name, variable, help));
}

CommandLine::Option& CommandLine::Option::takes_several() {
  option_->allow_extra_args(true)->expected(1, -1);
  return *this;
}

void CommandLine::add_algorithms_option() {
  add_option("--algorithms", algorithms_,
             "load a library with an algorithm of your own, as 'proleg new algorithm' makes it; scenarios name it as "
             "they name the built-in ones. May be repeated.")
      .value_name("LIBRARY");
}

void CommandLine::add_locked_algorithms_option() {
  add_algorithms_option();
  locks_signals_ = true;
}

std::string CommandLine::name() const { return app_->get_name(); }

std::vector<std::string> CommandLine::given() const {
  std::vector<std::string> names;
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    if (option->count() > 0) {
      names.push_back(option->get_name());
    }
  }
  return names;
}

int CommandLine::run(int argc, char** argv, const std::function<int()>& body) {
  const int status = run_body(argc, argv, body);
  expect_program_end();
  return status;
}

int CommandLine::run_body(int argc, char** argv, const std::function<int()>& body) {
  const auto print_error = [&](const std::exception& error) {
    std::cerr << app_->get_name() << ": " << one_line(error.what()) << '\n';
  };
  occupy_closed_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a file above the limit of its size is then an error like a full disk
  std::function<int()> action = body;
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help
    app_->exit(request);
    algorithms_.clear();
    prepare_ = [] {};
    action = [] { return exit_success; };
  } catch (const CLI::ParseError& error) {
    const ParseFailure failure = describe(*app_, error);
    std::cerr << app_->get_name() << ": found " << one_line(failure.found) << ", expected " << failure.expected
              << hint(*app_, error) << '\n';
    return exit_bad_input;
  }
  try {
    prepare_();
    if (locks_signals_ && !algorithms_.empty()) {
      catch_interrupts();
      lock_ending_signals();
    }
    load_algorithms(algorithms_);
    const int status = action();
    if (!std::cout.flush()) {
      throw std::runtime_error("cannot write to standard output");
    }
    return status;
  } catch (const InputError& error) {
    print_error(error);
    return exit_bad_input;
  } catch (const BadInput& error) {
    print_error(error);
    return exit_bad_input;
  } catch (const std::exception& error) {
    print_error(error);
    return exit_failed;
  }
}

std::uint32_t parse_workers(const std::optional<std::string>& argument) {
  if (!argument) {
    return std::clamp(std::thread::hardware_concurrency(), 1U, max_workers);
  }
  const std::optional<std::uint32_t> count = parse_whole<std::uint32_t>(*argument);
  if (!count || *count == 0 || *count > max_workers) {
    throw InputError("--workers", 0, in_quotes(*argument), "1 to " + std::to_string(max_workers));
  }
  return *count;
}

void catch_interrupts() {
  set_ending_signals([] {
    for (const int signal : ending_signals) {
      // An ignored signal remains ignored: nohup and scripts protect their jobs this way.
      if (std::signal(signal, [](int) { interrupt_flag = true; }) == SIG_IGN) {
        std::signal(signal, SIG_IGN);
      }
    }
  });
}

bool interrupted() { return interrupt_flag; }

}  // namespace proleg::tools
