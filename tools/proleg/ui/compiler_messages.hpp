#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::tools {

/// A message of a compiler, linker or CMake.
struct CompilerMessage {
  enum class Severity : std::uint8_t { error, warning, note };

  std::string file;          ///< as the program has printed it; empty: none
  std::uint32_t line = 0;    ///< from 1; 0: none
  std::uint32_t column = 0;  ///< in bytes, from 1; 0: none
  Severity severity = Severity::error;
  std::string text;  ///< one line
};

/// The messages in what a build has printed, in its order, each once: those of gcc and clang, undefined references, and
/// errors of CMake. At most 200.
[[nodiscard]] std::vector<CompilerMessage> compiler_messages(std::string_view output);

/// How far ninja has come: the numbers of "[3/25] ", the last ones in a text. 0 of 0: it has none.
struct BuildProgress {
  std::uint32_t done = 0;
  std::uint32_t of = 0;
};
[[nodiscard]] BuildProgress build_progress(std::string_view output);

}  // namespace proleg::tools
