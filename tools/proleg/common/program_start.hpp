#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace proleg::tools {

/// How another program starts. It gets no open files of this program but those named here, and English messages. It
/// runs without a shell.
struct ProgramStart {
  enum class Life : std::uint8_t {
    as_this_one,  ///< in a process group of its own: Ctrl-C at the terminal goes to this program alone
    its_own,      ///< in a session of its own, without a terminal: it goes on when this program ends, in any way
  };

  std::string folder;  ///< where it runs
  int output = -1;     ///< descriptor of its standard output
  int errors = -1;     ///< and of its standard error
  Life life = Life::as_this_one;
  int input = -1;         ///< descriptor of its standard input; -1: it has none
  int inherited = -1;     ///< a descriptor that it gets as number 3; -1: none
  bool gives_way = true;  ///< to programs that need the processor at the same time
  std::string mark{};     ///< for end_marked(); empty: none
};

/// The number of `inherited` in the other program.
inline constexpr int inherited_number = 3;

/// Starts it. command: the program, which is searched for as in a shell, and its arguments. Returns its process. Throws
/// std::runtime_error if it cannot be started.
[[nodiscard]] pid_t start_program(const std::vector<std::string>& command, const ProgramStart& start);

/// Ends at once all programs that one with this mark has started, also those in a session of their own. A program that
/// has cleared its environment, or belongs to another user, is not found.
void end_marked(const std::string& mark);

/// The exit status that a shell would report for a status of waitpid(2): 128 + the number of a signal.
[[nodiscard]] int exit_status_of(int wait_status);

}  // namespace proleg::tools
