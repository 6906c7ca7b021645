#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/evaluator.hpp"

namespace proleg::tools {

/// A line on standard error that says how far a search is: evaluations, best and mean score, simulated seconds in a
/// second, time to go, the course of the best. Nothing if that is not a terminal.
class SearchDisplay {
 public:
  /// label: what is searched, with the repetition if there are several. unit: of the score. budget: evaluations at
  /// most; 0: nobody knows.
  SearchDisplay(std::string label, std::string unit, std::uint64_t budget);
  /// Erases the line.
  ~SearchDisplay();
  SearchDisplay(const SearchDisplay&) = delete;
  SearchDisplay& operator=(const SearchDisplay&) = delete;

  /// Cheap; redraws at most ten times a second.
  void show(const optimize::Progress& progress);
  /// A line above it, also when standard error is no terminal.
  void say(const std::string& line);

 private:
  void erase();

  std::string label_;
  std::string unit_;
  std::uint64_t budget_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point next_;
  std::vector<double> best_so_far_;
};

/// The course of values as a row of block characters, at most `width` of them; empty if there are none.
[[nodiscard]] std::string spark_line(const std::vector<double>& values, std::size_t width);

/// "5 s", "4 min 10 s", "2 h 5 min".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace proleg::tools
