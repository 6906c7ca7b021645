#include "tools/proleg/search_display.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <utility>

namespace proleg::tools {

namespace {

/// Columns of the terminal at standard error; 80 if it does not say.
std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80;
}

}  // namespace

SearchDisplay::SearchDisplay(std::string label, std::string unit, std::uint64_t budget)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      budget_(budget),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      next_(start_) {}

SearchDisplay::~SearchDisplay() { erase(); }

void SearchDisplay::show(const optimize::Progress& progress) {
  if (!terminal_ || !progress.best) {
    return;
  }
  best_so_far_.push_back(progress.best->scores.front());
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) {
    return;
  }
  next_ = now + std::chrono::milliseconds(100);
  const double elapsed = std::max(std::chrono::duration<double>(now - start_).count(), 1e-3);
  const auto done = static_cast<double>(progress.evaluations);
  std::string line = label_ + ": " + std::to_string(progress.evaluations);
  if (budget_ > 0) {
    line += " of " + std::to_string(budget_);
  }
  std::array<char, 160> figures{};
  std::snprintf(figures.data(), figures.size(), ", best %.4g%s%s, mean %.4g, %.0f s/s", progress.best->scores.front(),
                unit_.empty() ? "" : " ", unit_.c_str(), progress.score_sum / done, progress.simulated_s / elapsed);
  line += figures.data();
  // What was restored took no time and says nothing about what is to come.
  const auto made_now = done - static_cast<double>(progress.restored);
  if (budget_ > progress.evaluations && made_now > 0.0) {
    line += ", " + duration_text(static_cast<double>(budget_ - progress.evaluations) * elapsed / made_now) + " to go";
  }
  // A line that wraps could not be erased: what does not fit is cut, the spark line first.
  const std::size_t width = terminal_width();
  const std::size_t left = width > line.size() + 3 ? width - line.size() - 3 : 0;
  std::cerr << "\r\033[K" << line.substr(0, width - 1) << (left > 0 ? "  " : "")
            << spark_line(best_so_far_, std::min<std::size_t>(left, 16)) << std::flush;
  shown_ = true;
}

void SearchDisplay::say(const std::string& line) {
  erase();
  std::cerr << line << '\n';
}

void SearchDisplay::erase() {
  if (std::exchange(shown_, false)) {
    std::cerr << "\r\033[K" << std::flush;
  }
}

std::string spark_line(const std::vector<double>& values, std::size_t width) {
  constexpr std::array blocks{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  if (values.empty() || width == 0) {
    return "";
  }
  const auto [low, high] = std::ranges::minmax_element(values);
  const std::size_t columns = std::min(width, values.size());
  std::string line;
  for (std::size_t column = 0; column < columns; ++column) {
    // The last value that falls into the column.
    const double value = values[(column + 1) * values.size() / columns - 1];
    const double share = *high > *low ? (value - *low) / (*high - *low) : 0.0;
    line += blocks[static_cast<std::size_t>(std::lround(share * (blocks.size() - 1)))];
  }
  return line;
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
