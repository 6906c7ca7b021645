#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "tools/proleg/common/child_program.hpp"

namespace proleg::tools {

/// How a child program has ended.
struct ChildEnd {
  enum class Reason : std::uint8_t {
    itself,
    late,     ///< it was ended because its time was over
    stopped,  ///< it was ended because the user stops
  };
  Reason reason;
  int status;                ///< ChildProgram::status()
  std::string output;        ///< standard output, of at most a megabyte
  std::string last_message;  ///< last line of standard error that is not empty; it was not passed on
};

/// Waits until a program has ended, or ends it: when its time is over, or when stop() is true, which is called often.
/// Returns when it has ended in any case. pass_on: gets the lines of its standard error as they come, but the last; a
/// thousand of them at most, and of each a thousand characters.
[[nodiscard]] ChildEnd wait_for_end(ChildProgram& child, std::chrono::duration<double> longest,
                                    const std::function<bool()>& stop,
                                    const std::function<void(const std::string& line)>& pass_on);

}  // namespace proleg::tools
