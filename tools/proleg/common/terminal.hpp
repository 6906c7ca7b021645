#pragma once

// The terminal of a program: lines on standard error that show progress, and lines that a person types.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

namespace proleg::tools {

/// A line on standard error that is drawn repeatedly to show progress. It is not drawn if standard error is no
/// terminal.
class TerminalLine {
 public:
  /// delay: time before the first drawing, so that short work shows no line.
  explicit TerminalLine(std::chrono::milliseconds delay);
  /// Erases the line.
  ~TerminalLine();
  TerminalLine(const TerminalLine&) = delete;
  TerminalLine& operator=(const TerminalLine&) = delete;

  /// Whether standard error is a terminal.
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

/// Determines when to print a line of a log: once in each interval.
class LogInterval {
 public:
  using Time = std::chrono::steady_clock::time_point;

  LogInterval(Time start, std::chrono::milliseconds interval) : interval_(interval), next_(start + interval) {}

  /// Whether an interval has passed since the start or the last time that this function returned true.
  [[nodiscard]] bool is_due(Time now) {
    if (now < next_) {
      return false;
    }
    next_ = now + interval_;
    return true;
  }

 private:
  std::chrono::milliseconds interval_;
  Time next_;
};

/// Text of a duration: "5 s", "4 min 10 s", "2 h 5 min".
[[nodiscard]] std::string duration_text(double seconds);

/// A line on standard error that shows the progress of a run. If standard error is no terminal, it is printed every ten
/// seconds.
class RunProgress {
 public:
  /// label: name of the work. total_s: simulated time of the whole run.
  RunProgress(std::string label, double total_s);

  /// Cheap; draws at most ten times a second.
  void show(double done_s);

 private:
  std::string label_;
  double total_s_;
  TerminalLine terminal_line_;
  LogInterval log_interval_;
};

/// A line on standard error that shows the progress of a number of runs.
class CountProgress {
 public:
  /// label: name of the counted things, as "runs"; total: their number.
  CountProgress(std::string label, std::uint64_t total);

  /// Cheap; draws at most ten times a second.
  void show(std::uint64_t done);
  /// share: of all that is done, 0 to 1.
  void show_share(double share);
  /// Erases the line, so that a message can be printed.
  void erase() { terminal_line_.erase(); }

 private:
  std::string label_;
  std::uint64_t total_;
  TerminalLine terminal_line_;
  LogInterval log_interval_;
};

/// Reads lines of standard input without waiting.
class InputLines {
 public:
  /// A longer line comes with one character more than this, before its end was read; the others are skipped.
  static constexpr std::size_t longest_line = 1'000;

  /// Takes the next whole line, without its end; nothing if none has come yet, or input has ended. A program in the
  /// background does not read from its terminal.
  [[nodiscard]] std::optional<std::string> next();
  /// Whether no further line will come.
  [[nodiscard]] bool has_ended() const { return has_ended_ && lines_.empty(); }

 private:
  /// Whether something has come.
  bool read_available();
  void add(std::string_view text, bool is_end_of_line);

  bool has_ended_ = false;
  bool skips_line_ = false;  ///< the rest of a line that was too long
  std::string rest_;
  std::deque<std::string> lines_;
};

}  // namespace proleg::tools
