#pragma once

#include <string>
#include <vector>

#include "tools/proleg/common/terminal_line.hpp"

namespace proleg::tools {

/// A bar for each module on standard error, drawn again and again. Nothing if standard error is no terminal.
class FlashProgress {
 public:
  FlashProgress() : line_(std::chrono::milliseconds(0)) {}
  ~FlashProgress() { erase(); }
  FlashProgress(const FlashProgress&) = delete;
  FlashProgress& operator=(const FlashProgress&) = delete;

  struct Bar {
    std::string name;
    double part = 0;  ///< 0 to 1
    std::string state;
  };
  /// True at most ten times a second: time to draw.
  [[nodiscard]] bool is_due() { return line_.is_due(); }
  /// Terminals with fewer lines show the first ones.
  void draw(const std::vector<Bar>& bars);
  void erase();

 private:
  TerminalLine line_;
  std::size_t drawn_ = 0;  ///< lines
};

}  // namespace proleg::tools
