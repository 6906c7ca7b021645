#include "tools/proleg/ui/seat_program.hpp"

#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr std::size_t most_bytes_of_line = std::size_t{64} << 10U;
constexpr std::size_t most_bytes_of_errors = 4096;
constexpr int signal_status = 128;

std::string last_line(std::string_view text) {
  const std::string_view lines = trimmed(text);
  const std::size_t end = lines.rfind('\n');
  return one_line(end == std::string_view::npos ? lines : lines.substr(end + 1));
}

std::string end_text(int status, const std::string& errors) {
  std::string text = status > signal_status ? "the program ended with signal " + std::to_string(status - signal_status)
                                            : "the program ended with status " + std::to_string(status);
  const std::string reason = last_line(errors);
  return reason.empty() ? text : text + ": " + shortened(reason, 200);
}

}  // namespace

SeatProgram::SeatProgram(const std::vector<std::string>& command, const std::filesystem::path& folder,
                         const json& settings, Time now)
    : child_(ChildProgram::with_input(command, folder.string(), -1)), started_(now) {
  child_->write_line(settings.dump(-1, ' ', true));
}

std::vector<SeatProgram::Stopped> SeatProgram::poll(Time now) {
  std::vector<Stopped> stopped;
  if (state_ == State::ended) {
    return stopped;
  }
  const std::optional<int> status = child_->status();  // before the reading: what it wrote before its end is read
  rest_ += child_->read();
  last_errors_ += child_->read_errors();
  if (last_errors_.size() > most_bytes_of_errors) {
    last_errors_.erase(0, last_errors_.size() - most_bytes_of_errors);
  }
  for (std::size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n')) {
    take_line(rest_.substr(0, end), stopped);
    rest_.erase(0, end + 1);
  }
  if (rest_.size() > most_bytes_of_line) {
    rest_.clear();
  }
  if (status) {
    state_ = State::ended;
    problem_ = end_text(*status, last_errors_);
  } else if (state_ == State::starting && now >= started_ + longest_start) {
    child_->end();
  }
  return stopped;
}

void SeatProgram::take_line(const std::string& line, std::vector<Stopped>& stopped) {
  const json message = json::parse(line, nullptr, false);
  if (!message.is_object()) {
    return;
  }
  if (const auto port = message.find("port"); port != message.end() && is_whole_number<std::uint16_t>(*port)) {
    port_ = port->get<std::uint16_t>();
    state_ = State::ready;
  } else if (const auto number = message.find("stopped");
             number != message.end() && is_whole_number<std::uint64_t>(*number)) {
    stopped.push_back({number->get<std::uint64_t>(), message.value("confirmed", 0U), message.value("of", 0U)});
  }
}

void SeatProgram::end() {
  if (state_ != State::ended) {
    child_->end();
  }
}

}  // namespace proleg::tools
