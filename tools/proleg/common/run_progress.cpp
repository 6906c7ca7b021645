#include "tools/proleg/common/run_progress.hpp"

#include <array>
#include <cstdio>
#include <iostream>
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

}  // namespace proleg::tools
