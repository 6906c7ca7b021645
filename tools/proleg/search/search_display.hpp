#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/evaluator.hpp"
#include "tools/proleg/common/terminal_line.hpp"

namespace proleg::tools {

/// Shows the progress of a search on standard error: evaluations, best and mean score, simulated seconds per second,
/// remaining time. On a terminal it is one line that is drawn repeatedly, with a spark line of the best score.
/// Elsewhere a line is printed every ten seconds.
class SearchDisplay {
 public:
  /// label: name of the search, with the repetition if it has several. unit: unit of the score. budget: most
  /// evaluations; 0: unknown.
  SearchDisplay(std::string label, std::string unit, std::uint64_t budget);

  /// Redraws at most ten times a second, or prints a line every ten seconds.
  void show(const optimize::SearchProgress& progress);
  /// Prints a line above the display, also if standard error is not a terminal.
  void print(const std::string& line);

 private:
  std::string label_;
  std::string unit_;
  std::uint64_t budget_;
  TerminalLine terminal_line_;
  LogInterval log_interval_;
  std::vector<double> best_so_far_;
};

/// Evaluations, scores, speed and remaining time of a search in one line. elapsed_s: time since its start; above 0.
[[nodiscard]] std::string progress_text(const std::string& label, const std::string& unit, std::uint64_t budget,
                                        const optimize::SearchProgress& progress, double elapsed_s);

/// The values as block characters, at most `width`; empty without values.
[[nodiscard]] std::string spark_line(const std::vector<double>& values, std::size_t width);

}  // namespace proleg::tools
