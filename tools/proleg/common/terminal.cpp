#include "tools/proleg/common/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <utility>

namespace proleg::tools {

RunProgress::RunProgress(std::string label, double total_s)
    : label_(std::move(label)),
      total_s_(total_s),
      terminal_line_(std::chrono::milliseconds(200)),
      log_interval_(std::chrono::steady_clock::now(), std::chrono::seconds(10)) {}

void RunProgress::show(double done_s) {
  const bool is_due =
      terminal_line_.is_visible() ? terminal_line_.is_due() : log_interval_.is_due(std::chrono::steady_clock::now());
  if (!is_due) {
    return;
  }
  const double rate = done_s / terminal_line_.elapsed_s();
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), "%s %.1f of %.1f s, %.0f x real time, %.0f s left", label_.c_str(), done_s,
                total_s_, rate, rate > 0.0 ? (total_s_ - done_s) / rate : 0.0);
  if (terminal_line_.is_visible()) {
    terminal_line_.draw(text.data());
  } else {
    std::cerr << text.data() << '\n';
  }
}

CountProgress::CountProgress(std::string label, std::uint64_t total)
    : label_(std::move(label)),
      total_(total),
      terminal_line_(std::chrono::milliseconds(200)),
      log_interval_(std::chrono::steady_clock::now(), std::chrono::seconds(10)) {}

void CountProgress::show(std::uint64_t done) {
  const bool is_due =
      terminal_line_.is_visible() ? terminal_line_.is_due() : log_interval_.is_due(std::chrono::steady_clock::now());
  if (!is_due || done == 0) {
    return;
  }
  const double left_s = terminal_line_.elapsed_s() * static_cast<double>(total_ - done) / static_cast<double>(done);
  const std::string text =
      std::to_string(done) + " of " + std::to_string(total_) + " " + label_ + ", " + duration_text(left_s) + " left";
  if (terminal_line_.is_visible()) {
    terminal_line_.draw(text);
  } else {
    std::cerr << text << '\n';
  }
}

void CountProgress::show_share(double share) {
  show(static_cast<std::uint64_t>(std::lround(share * static_cast<double>(total_))));
}

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

std::optional<std::string> InputLines::next() {
  constexpr int most_blocks = 256;  // a megabyte: input without an end must not keep the program
  for (int i = 0; i < most_blocks && lines_.empty() && !has_ended_ && read_available(); ++i) {
  }
  if (lines_.empty()) {
    return std::nullopt;
  }
  std::string line = lines_.front();
  lines_.pop_front();
  return line;
}

void InputLines::add(std::string_view text, bool is_end_of_line) {
  if (!skips_line_) {
    rest_ += text.substr(0, longest_line + 1 - rest_.size());
    if (is_end_of_line || rest_.size() > longest_line) {
      lines_.push_back(std::exchange(rest_, {}));
      skips_line_ = true;
    }
  }
  skips_line_ = skips_line_ && !is_end_of_line;
}

bool InputLines::read_available() {
  const bool is_in_background = isatty(STDIN_FILENO) == 1 && tcgetpgrp(STDIN_FILENO) != getpgrp();
  pollfd request{STDIN_FILENO, POLLIN, 0};
  if (is_in_background || poll(&request, 1, 0) <= 0) {
    return false;
  }
  std::array<char, 4096> buffer;
  const ssize_t count = read(STDIN_FILENO, buffer.data(), buffer.size());
  if (count <= 0) {
    has_ended_ = count == 0 || (errno != EINTR && errno != EAGAIN);
    if (has_ended_ && !rest_.empty()) {
      lines_.push_back(std::exchange(rest_, {}));  // the last line has no line end
    }
    return false;
  }
  std::string_view text(buffer.data(), static_cast<std::size_t>(count));
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    add(text.substr(0, end), true);
    text.remove_prefix(end + 1);
  }
  add(text, false);
  return true;
}

}  // namespace proleg::tools
