#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/proleg/common/child_program.hpp"

namespace proleg::tools {

/// The last line that a program has printed, without blanks; empty if there is none.
[[nodiscard]] std::string last_line_of(std::string_view output);

/// The same of what a program has added to a file; empty if there is no such file.
[[nodiscard]] std::string last_line_of_file(const std::filesystem::path& log);

/// A message of one of our programs without the name of the program: "TEXT" of "proleg optimise: TEXT".
[[nodiscard]] std::string without_program_name(const std::string& line);

/// Programs that run one after the other, up to the first one that fails, within a time.
class CommandSequence {
 public:
  static constexpr std::size_t most_output = std::size_t{1} << 20U;
  static constexpr std::size_t most_errors = std::size_t{1} << 16U;

  using Clock = std::chrono::steady_clock;
  /// How it has ended.
  struct End {
    bool is_cancelled = false;
    bool is_late = false;  ///< it took too long, and was ended
    int status = 0;        ///< exit status of the last program that ran
  };

  /// Starts the first one. commands: at least one; each is a program and its arguments. folder: where they run. Throws
  /// std::runtime_error if it cannot be started.
  CommandSequence(std::vector<std::vector<std::string>> commands, std::string folder, std::chrono::seconds longest,
                  ChildProgram::Errors errors = ChildProgram::Errors::in_output);

  /// Takes what has been written, and starts the next program when one has ended. Does not wait. Throws
  /// std::runtime_error if that cannot be started. Returns the end; nothing as long as a program runs.
  std::optional<End> look();
  /// Ends the present program, and starts no other; look() says when it has ended.
  void cancel();

  /// What the programs have written until now, up to the first mebibyte.
  [[nodiscard]] const std::string& output() const { return output_; }
  /// Of standard error, if it is kept apart, the last 64 KiB.
  [[nodiscard]] const std::string& errors() const { return errors_; }

 private:
  void start_next();

  std::vector<std::vector<std::string>> commands_;  ///< that are still to be started
  std::string folder_;
  ChildProgram::Errors errors_kind_;
  Clock::time_point until_;
  std::unique_ptr<ChildProgram> child_;
  std::string output_;
  std::string errors_;
  bool is_cancelled_ = false;
  bool is_late_ = false;
};

}  // namespace proleg::tools
