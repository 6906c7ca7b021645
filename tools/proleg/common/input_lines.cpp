#include "tools/proleg/common/input_lines.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace proleg::tools {

std::optional<std::string> InputLines::next() {
  if (lines_.empty() && !has_ended_) {
    read_available();
  }
  if (lines_.empty()) {
    return std::nullopt;
  }
  std::string line = lines_.front();
  lines_.pop_front();
  return line;
}

void InputLines::read_available() {
  const bool is_in_background = isatty(STDIN_FILENO) == 1 && tcgetpgrp(STDIN_FILENO) != getpgrp();
  pollfd request{STDIN_FILENO, POLLIN, 0};
  if (is_in_background || poll(&request, 1, 0) <= 0) {
    return;
  }
  std::array<char, 4096> buffer;
  const ssize_t count = read(STDIN_FILENO, buffer.data(), buffer.size());
  if (count <= 0) {
    has_ended_ = count == 0 || (errno != EINTR && errno != EAGAIN);
    if (has_ended_ && !rest_.empty()) {
      lines_.push_back(std::exchange(rest_, {}));  // the last line has no line end
    }
    return;
  }
  rest_.append(buffer.data(), static_cast<std::size_t>(count));
  for (std::size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n')) {
    lines_.push_back(rest_.substr(0, end));
    rest_.erase(0, end + 1);
  }
}

}  // namespace proleg::tools
