#include "tools/proleg/common/terminal_line.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>

namespace proleg::tools {

using std::chrono::steady_clock;

TerminalLine::TerminalLine(std::chrono::milliseconds delay)
    : is_terminal_(isatty(STDERR_FILENO) == 1), start_(steady_clock::now()), next_drawing_(start_ + delay) {}

TerminalLine::~TerminalLine() { erase(); }

bool TerminalLine::is_due() {
  if (!is_terminal_) {
    return false;
  }
  const steady_clock::time_point now = steady_clock::now();
  if (now < next_drawing_) {
    return false;
  }
  next_drawing_ = now + std::chrono::milliseconds(100);
  return true;
}

double TerminalLine::elapsed_s() const {
  return std::max(std::chrono::duration<double>(steady_clock::now() - start_).count(), 1e-3);
}

std::size_t TerminalLine::max_width() {
  winsize size{};
  return (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : std::size_t{80}) - 1;
}

void TerminalLine::draw(std::string_view text) {
  std::cerr << "\r\033[K" << text << std::flush;
  is_drawn_ = true;
}

void TerminalLine::erase() {
  if (std::exchange(is_drawn_, false)) {
    std::cerr << "\r\033[K" << std::flush;
  }
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::min(seconds, 1e9)));
  if (whole < 60) {
    return std::to_string(whole) + " s";
  }
  if (whole < 3600) {
    return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  }
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

}  // namespace proleg::tools
