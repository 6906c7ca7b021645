#pragma once

#include <string>

namespace proleg::tools {

/// An argument of a command that is printed for the user to repeat: in quotes for a shell, if it needs them.
[[nodiscard]] std::string shell_word(const std::string& word);

/// Text " --algorithms LIBRARY" for each library that this program has loaded, in their order; mostly empty. A command
/// that repeats or continues a run needs them.
[[nodiscard]] std::string algorithm_options();

}  // namespace proleg::tools
