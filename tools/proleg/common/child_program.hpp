#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::tools {

/// Another program that runs beside this one (program_start.hpp) and ends with it: its output is read as it comes, and
/// it can be ended.
class ChildProgram {
 public:
  enum class Errors : std::uint8_t {
    in_output,  ///< read() gives both, in the order in which they were written
    apart,      ///< read_errors() gives standard error
  };

  /// Starts it in a folder. command: the program, which is searched for as in a shell, and its arguments. Throws
  /// std::runtime_error if it cannot be started.
  ChildProgram(const std::vector<std::string>& command, const std::string& folder, Errors errors = Errors::in_output);
  /// The same for a program that takes lines on its standard input, and a descriptor, as number inherited_number; -1:
  /// none. It does not give way to others. Its standard error is apart. time_to_end: that end() gives it.
  static std::unique_ptr<ChildProgram> with_input(const std::vector<std::string>& command, const std::string& folder,
                                                  int inherited, std::chrono::seconds time_to_end = usual_time_to_end);
  /// Ends it, with the programs that it has started.
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  /// What it has written since the last call, at most most_at_once and a little more: a program that writes without an
  /// end must not keep its reader. All that a program wrote before its end is less. Does not wait.
  [[nodiscard]] std::string read() { return read_from(output_.end); }
  /// The same of standard error alone; nothing without Errors::apart.
  [[nodiscard]] std::string read_errors() { return errors_ ? read_from(errors_->end) : std::string(); }
  /// Gives it a line; the program may have ended. False: it takes none now.
  bool write_line(std::string_view line);
  /// Its exit status, or 128 + the number of a signal, as a shell reports it; nothing as long as it runs. Does not
  /// wait. What it has started ends with it. Output that it wrote before can still be read.
  [[nodiscard]] std::optional<int> status();
  /// Asks it to end, and ends it if it has not done so in time; status() says when it has ended. What it has started
  /// ends with it then also in a session of its own.
  void end();

  static constexpr std::chrono::seconds usual_time_to_end{3};
  static constexpr std::size_t most_at_once = 1'048'576;  ///< as much as a pipe of Linux can hold

 private:
  using Clock = std::chrono::steady_clock;

  /// The end of a pipe that is read.
  struct Pipe {
    int end;
    int other_end;  ///< until the child has it
    Pipe();
    explicit Pipe(const std::array<int, 2>& ends) : end(ends[0]), other_end(ends[1]) {}
    ~Pipe();
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    void close_other_end();
  };
  [[nodiscard]] static std::string read_from(int pipe);
  ChildProgram(const std::vector<std::string>& command, const std::string& folder, Errors errors, bool has_input,
               int inherited);

  Pipe output_;
  std::optional<Pipe> errors_;
  std::optional<Pipe> input_;  ///< a pair of sockets: a write to a program that has ended sends no signal
  std::string mark_;
  pid_t process_ = 0;
  std::chrono::seconds time_to_end_ = usual_time_to_end;
  std::optional<int> status_;
  std::optional<Clock::time_point> killed_at_;
};

}  // namespace proleg::tools
