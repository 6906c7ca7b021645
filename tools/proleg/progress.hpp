#pragma once

#include <chrono>
#include <string>

namespace proleg::tools {

/// A line on standard error that says how far a run is; nothing if that is not a terminal.
class Progress {
 public:
  /// label: what is being done; total: in the unit of `show`.
  Progress(std::string label, std::string unit, double total);
  /// Erases the line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Cheap; redraws at most ten times a second.
  void show(double done);

 private:
  std::string label_;
  std::string unit_;
  double total_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace proleg::tools
