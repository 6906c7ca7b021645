#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace proleg {

/// What a function did in a child.
struct Trial {
  bool has_returned = false;
  std::string text;  ///< what it returned; else "ends the program with SIGBUS", "does not end within 10 s"
};

/// Runs a function that returns at most a line in a forked child, for code that may end the program that runs it, such
/// as the one that loads a damaged library. Nothing of the child remains but the text, and it writes nowhere. Throws
/// std::system_error if the system cannot start a process.
[[nodiscard]] Trial try_in_child(const std::function<std::string()>& function,
                                 std::chrono::seconds limit = std::chrono::seconds(10));

}  // namespace proleg
