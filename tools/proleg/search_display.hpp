#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/evaluator.hpp"
#include "tools/proleg/terminal_line.hpp"

namespace proleg::tools {

/// A line on standard error that says how far a search is: evaluations, best and mean score, simulated seconds in a
/// second, time to go, the course of the best. Nothing if that is not a terminal.
class SearchDisplay {
 public:
  /// label: what is searched, with the repetition if there are several. unit: of the score. budget: evaluations at
  /// most; 0: nobody knows.
  SearchDisplay(std::string label, std::string unit, std::uint64_t budget);

  /// Cheap; redraws at most ten times a second.
  void show(const optimize::Progress& progress);
  /// A line above it, also when standard error is no terminal.
  void say(const std::string& line);

 private:
  std::string label_;
  std::string unit_;
  std::uint64_t budget_;
  TerminalLine terminal_line_;
  std::vector<double> best_so_far_;
};

/// The course of values as a row of block characters, at most `width` of them; empty if there are none.
[[nodiscard]] std::string spark_line(const std::vector<double>& values, std::size_t width);

}  // namespace proleg::tools
