#include "tools/proleg/flash/flash_progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace proleg::tools {
namespace {

constexpr std::size_t bar_width = 24;

std::size_t max_lines() {
  winsize size{};
  return (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 2 ? size.ws_row : std::size_t{24}) - 1;
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

}  // namespace

void FlashProgress::draw(const std::vector<Bar>& bars) {
  if (!line_.is_visible()) {
    return;
  }
  std::size_t name_width = 0;
  for (const Bar& bar : bars) {
    name_width = std::max(name_width, bar.name.size());
  }
  std::string text;
  const std::size_t lines = std::min(bars.size(), max_lines());
  for (std::size_t i = 0; i < lines; ++i) {
    const Bar& bar = bars[i];
    const auto filled =
        static_cast<std::size_t>(std::lround(std::clamp(bar.part, 0.0, 1.0) * static_cast<double>(bar_width)));
    std::string line = padded(bar.name, name_width) + "  [" + std::string(filled, '#') +
                       std::string(bar_width - filled, '.') + "]  " + bar.state;
    line.resize(std::min(line.size(), TerminalLine::max_width()));
    text += "\r\033[K" + line + '\n';
  }
  erase();
  std::cerr << text << std::flush;
  drawn_ = lines;
}

void FlashProgress::erase() {
  if (drawn_ != 0) {
    // Back to the first of them, and away with all below.
    std::cerr << "\033[" << drawn_ << "A\r\033[J" << std::flush;
    drawn_ = 0;
  }
}

}  // namespace proleg::tools
