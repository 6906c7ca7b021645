#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

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

/// The words that a program may be started with. CLI11, which takes seconds to compile wherever it is included, is
/// known to the source file only.
class CommandLine {
 public:
  class Option {
   public:
    Option& required();
    /// What --help calls its value; "": nothing.
    Option& value_name(const std::string& name);
    Option& excludes(const std::string& other);
    /// Whether --help says the value that its variable has now.
    Option& shows_default();

   private:
    friend class CommandLine;
    explicit Option(CLI::Option* option) : option_(option) {}
    CLI::Option* option_;
  };

  /// name: "proleg simulate". help: what it does.
  CommandLine(const std::string& name, const std::string& help);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// An option with a value ("--out"), or a word by its place ("FILE"). The variable keeps what it has if the option is
  /// not given, and must outlive this; a vector takes one value each time the option is given.
  Option add_option(const std::string& name, std::string& variable, const std::string& help);
  Option add_option(const std::string& name, std::optional<std::string>& variable, const std::string& help);
  Option add_option(const std::string& name, std::optional<double>& variable, const std::string& help);
  Option add_option(const std::string& name, std::vector<std::string>& variable, const std::string& help);
  /// An option without a value.
  Option add_flag(const std::string& name, bool& variable, const std::string& help);

  [[nodiscard]] std::string name() const;

  /// Parses the words and runs the body; the exit status. What goes wrong becomes one line on standard error:
  /// bad words, an InputError or a BadInput give status 2, any other exception status 1. --help gives 0.
  int run(int argc, char** argv, const std::function<int()>& body);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace proleg::tools
