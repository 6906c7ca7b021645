#pragma once

// The command line of a program, its exit status, and signals that end it.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace proleg::tools {

/// Exit statuses of every program.
inline constexpr int exit_success = 0;
inline constexpr int exit_failed = 1;     ///< the run failed
inline constexpr int exit_bad_input = 2;  ///< the input is unusable; no work was started

/// The user's input cannot be used, and no work has started. what() is the whole message. It is for errors without the
/// form of an InputError.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Prints "proleg simulate: warning: TEXT" on standard error, as one line. All warnings begin like this.
void print_warning(const std::string& program, const std::string& text);

/// The command line of a program. Only the source file includes CLI11, whose compilation takes seconds.
class CommandLine {
 public:
  class Option {
   public:
    Option& required();
    /// Sets the name of the value in --help; "" for none.
    Option& value_name(const std::string& name);
    Option& excludes(const std::string& other);
    /// Lets a positional argument take all arguments up to the next option, at least one.
    Option& takes_several();
    /// Lets --help show the present value of the variable.
    Option& shows_default();

   private:
    friend class CommandLine;
    explicit Option(CLI::Option* option) : option_(option) {}
    CLI::Option* option_;
  };

  /// name: name of the program, as "proleg simulate". help: its purpose.
  CommandLine(const std::string& name, const std::string& help);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Adds an option with a value ("--out"), or a positional argument ("FILE"). Without it the variable keeps its value.
  /// Each use of the option adds one value to a vector. The variable must outlive this object.
  Option add_option(const std::string& name, std::string& variable, const std::string& help);
  Option add_option(const std::string& name, std::optional<std::string>& variable, const std::string& help);
  Option add_option(const std::string& name, std::optional<double>& variable, const std::string& help);
  Option add_option(const std::string& name, std::vector<std::string>& variable, const std::string& help);
  /// Adds an option without a value.
  Option add_flag(const std::string& name, bool& variable, const std::string& help);

  /// Adds --algorithms, for programs that read scenarios or name parameters. run() loads the libraries before the body.
  void add_algorithms_option();
  /// The same for programs that start no programs of others: run() catches interrupts, and no library can change that.
  void add_locked_algorithms_option();

  /// run() calls this before the body, after the variables have their values. An exception is as one of the body.
  void prepare_with(std::function<void()> prepare) { prepare_ = std::move(prepare); }
  [[nodiscard]] std::string name() const;
  /// The options and positional arguments that the user has given ("--out", "FILE"), for the body of run().
  [[nodiscard]] std::vector<std::string> given() const;

  /// Parses the arguments and runs the body; returns the exit status. An error is one line on standard error: bad
  /// arguments, an InputError or a BadInput give status 2, any other exception status 1. --help gives 0 if it can be
  /// printed.
  int run(int argc, char** argv, const std::function<int()>& body);

 private:
  int run_body(int argc, char** argv, const std::function<int()>& body);

  std::unique_ptr<CLI::App> app_;
  std::vector<std::string> algorithms_;
  bool locks_signals_ = false;
  std::function<void()> prepare_ = [] {};
};

inline constexpr std::uint32_t max_workers = 1024;

/// Parses --workers; by default one for each processor. Throws InputError.
[[nodiscard]] std::uint32_t parse_workers(const std::optional<std::string>& argument);

/// After this call SIGINT, SIGTERM and SIGHUP only make interrupted() true. Ignored signals remain ignored (nohup).
void catch_interrupts();
[[nodiscard]] bool interrupted();

}  // namespace proleg::tools
