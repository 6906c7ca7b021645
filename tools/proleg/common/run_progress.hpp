#pragma once

#include <cstdint>
#include <string>

#include "tools/proleg/common/terminal_line.hpp"

namespace proleg::tools {

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
  /// Erases the line, so that a message can be printed.
  void erase() { terminal_line_.erase(); }

 private:
  std::string label_;
  std::uint64_t total_;
  TerminalLine terminal_line_;
  LogInterval log_interval_;
};

}  // namespace proleg::tools
