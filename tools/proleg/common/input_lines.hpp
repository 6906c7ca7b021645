#pragma once

#include <deque>
#include <optional>
#include <string>

namespace proleg::tools {

/// Reads lines of standard input without waiting.
class InputLines {
 public:
  /// Takes the next whole line, without its end; nothing if none has come yet, or input has ended. A program in the
  /// background does not read from its terminal.
  [[nodiscard]] std::optional<std::string> next();
  /// Whether no further line will come.
  [[nodiscard]] bool has_ended() const { return has_ended_ && lines_.empty(); }

 private:
  void read_available();

  bool has_ended_ = false;
  std::string rest_;
  std::deque<std::string> lines_;
};

}  // namespace proleg::tools
