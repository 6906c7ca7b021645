#include "tools/proleg/progress.hpp"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace proleg::tools {

Progress::Progress(std::string label, std::string unit, double total)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      next_(start_ + std::chrono::milliseconds(200)) {}

Progress::~Progress() {
  if (shown_) {
    std::fputs("\r\033[K", stderr);
  }
}

void Progress::show(double done) {
  if (!terminal_) {
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) {
    return;
  }
  next_ = now + std::chrono::milliseconds(100);
  shown_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = done / elapsed;
  std::fprintf(stderr, "\r\033[K%s %.1f of %.1f %s, %.0f x real time, %.0f s to go", label_.c_str(), done, total_,
               unit_.c_str(), rate, rate > 0.0 ? (total_ - done) / rate : 0.0);
  std::fflush(stderr);
}

}  // namespace proleg::tools
