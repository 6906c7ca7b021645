#include "tools/proleg/search/search_display.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <utility>

namespace proleg::tools {

SearchDisplay::SearchDisplay(std::string label, std::string unit, std::uint64_t budget)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      budget_(budget),
      terminal_line_(std::chrono::milliseconds(0)),
      log_interval_(std::chrono::steady_clock::now(), std::chrono::seconds(10)) {}

void SearchDisplay::show(const optimize::SearchProgress& progress) {
  if (!terminal_line_.is_visible()) {
    if (log_interval_.is_due(std::chrono::steady_clock::now())) {
      print(progress_text(label_, unit_, budget_, progress, terminal_line_.elapsed_s()));
    }
    return;
  }
  if (progress.best) {
    best_so_far_.push_back(progress.best->scores.front());
  }
  if (!terminal_line_.is_due()) {
    return;
  }
  const std::string line = progress_text(label_, unit_, budget_, progress, terminal_line_.elapsed_s());
  const std::size_t width = TerminalLine::max_width();
  const std::size_t rest = width > line.size() + 2 ? width - line.size() - 2 : 0;
  terminal_line_.draw(line.substr(0, width) + (rest > 0 ? "  " : "") +
                      spark_line(best_so_far_, std::min<std::size_t>(rest, 16)));
}

void SearchDisplay::print(const std::string& line) {
  terminal_line_.erase();
  std::cerr << line << '\n';
}

std::string progress_text(const std::string& label, const std::string& unit, std::uint64_t budget,
                          const optimize::SearchProgress& progress, double elapsed_s) {
  const auto done = static_cast<double>(progress.evaluations);
  std::string line = label + ": " + std::to_string(progress.evaluations);
  if (budget > 0) {
    line += " of " + std::to_string(budget);
  }
  std::array<char, 160> figures{};
  if (progress.best) {
    std::snprintf(figures.data(), figures.size(), ", best %.4g%s%s, mean %.4g, %.0f s/s", progress.best->scores.front(),
                  unit.empty() ? "" : " ", unit.c_str(), progress.score_sum / done, progress.simulated_s / elapsed_s);
  } else {
    std::snprintf(figures.data(), figures.size(), ", all failed, %.0f s/s", progress.simulated_s / elapsed_s);
  }
  line += figures.data();
  // Restored evaluations took no time, so they are no measure of the remaining time.
  const auto made_now = done - static_cast<double>(progress.restored);
  if (budget > progress.evaluations && made_now > 0.0) {
    line += ", " + duration_text(static_cast<double>(budget - progress.evaluations) * elapsed_s / made_now) + " left";
  }
  return line;
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
    // The column shows its last value.
    const double value = values[(column + 1) * values.size() / columns - 1];
    const double share = *high > *low ? (value - *low) / (*high - *low) : 0.0;
    line += blocks[static_cast<std::size_t>(std::lround(share * (blocks.size() - 1)))];
  }
  return line;
}

}  // namespace proleg::tools
