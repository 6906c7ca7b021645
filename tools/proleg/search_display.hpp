#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/evaluator.hpp"
#include "tools/proleg/terminal_line.hpp"

namespace proleg::tools {

/// A line on standard error with the progress of a search: evaluations, best and mean score, simulated seconds per
/// second, remaining time, a spark line of the best score. Nothing if standard error is not a terminal.
class SearchDisplay {
 public:
  /// label: name of the search, with the repetition if there are several. unit: of the score. budget: most evaluations;
  /// 0: unknown.
  SearchDisplay(std::string label, std::string unit, std::uint64_t budget);

  /// Redraws at most ten times a second.
  void show(const optimize::SearchProgress& progress);
  /// Prints a line above it, also if standard error is not a terminal.
  void print(const std::string& line);

 private:
  std::string label_;
  std::string unit_;
  std::uint64_t budget_;
  TerminalLine terminal_line_;
  std::vector<double> best_so_far_;
};

/// The values as block characters, at most `width`; empty without values.
[[nodiscard]] std::string spark_line(const std::vector<double>& values, std::size_t width);

}  // namespace proleg::tools
