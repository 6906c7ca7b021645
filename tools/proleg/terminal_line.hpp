#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

namespace proleg::tools {

/// A line on standard error that is drawn again and again to show progress. Nothing if standard error is no terminal.
class TerminalLine {
 public:
  /// delay: before the first drawing, so that short work shows nothing.
  explicit TerminalLine(std::chrono::milliseconds delay);
  /// Erases the line.
  ~TerminalLine();
  TerminalLine(const TerminalLine&) = delete;
  TerminalLine& operator=(const TerminalLine&) = delete;

  /// False without a terminal.
  [[nodiscard]] bool is_visible() const { return is_terminal_; }
  /// True at most ten times a second, and never without a terminal: time to draw.
  [[nodiscard]] bool is_due();
  [[nodiscard]] double elapsed_s() const;
  /// Characters that fit on the line; 80 if the terminal does not report its width. A line that wraps cannot be erased.
  [[nodiscard]] static std::size_t max_width();

  void draw(std::string_view text);
  void erase();

 private:
  bool is_terminal_;
  bool is_drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point next_drawing_;
};

/// "5 s", "4 min 10 s", "2 h 5 min".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace proleg::tools
