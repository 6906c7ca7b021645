#pragma once

#include <cstdint>
#include <string>

#include "tools/proleg/common/terminal_line.hpp"

namespace proleg::tools {

/// A line on standard error that shows how much of a run is done. If standard error is no terminal, it is printed every
/// ten seconds.
class RunProgress {
 public:
  /// label: what is being done. total_s: simulated time of the whole run.
  RunProgress(std::string label, double total_s);

  /// Cheap; draws at most ten times a second.
  void show(double done_s);

 private:
  std::string label_;
  double total_s_;
  TerminalLine terminal_line_;
  LogInterval log_interval_;
};

/// The same for a number of runs.
class CountProgress {
 public:
  /// label: what is counted, such as "runs"; total: how many there are.
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
