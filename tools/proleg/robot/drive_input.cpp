#include "tools/proleg/robot/drive_input.hpp"

#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

DriveInput::DriveInput(bool ends_the_run, const std::optional<std::string>& longest_silence)
    : ends_the_run_(ends_the_run) {
  if (longest_silence) {
    const std::optional<double> seconds = parse_number(*longest_silence);
    if (!seconds || !(*seconds >= 0.1 && *seconds <= 60.0)) {
      throw InputError("--longest-silence", 0, in_quotes(*longest_silence), "0.1 to 60 seconds");
    }
    longest_silence_ = std::chrono::duration<double>(*seconds);
  }
}

std::optional<std::string> DriveInput::next() {
  look();
  if (lines_.empty()) {
    return std::nullopt;
  }
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

bool DriveInput::is_silent() {
  look();
  return longest_silence_ && Clock::now() - heard_at_ > *longest_silence_;
}

/// Takes what has come; of input without an end, some.
void DriveInput::look() {
  constexpr std::size_t most_lines = 1'000;
  while (lines_.size() < most_lines) {
    std::optional<std::string> line = input_.next();
    if (!line) {
      return;
    }
    heard_at_ = Clock::now();
    lines_.push_back(*std::move(line));
  }
}

}  // namespace proleg::tools
