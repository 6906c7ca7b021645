#include "tools/proleg/ui/seat_input.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <iostream>
#include <nlohmann/json.hpp>

#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr int settings_patience_ms = 10'000;
constexpr int look_period_ms = 200;
constexpr std::size_t most_handed_out = 20;

void print(const json& line) { std::cout << line.dump() + "\n" << std::flush; }

}  // namespace

InputLines::Wait InputLines::wait(int milliseconds) {
  while (rest_.find('\n') == std::string::npos) {
    if (has_ended_) {
      return Wait::end;
    }
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const int ready = ::poll(&input, 1, milliseconds);
    if (ready == 0 || (ready < 0 && errno == EINTR)) {
      return Wait::nothing;
    }
    std::array<char, 4096> bytes{};
    const ssize_t length = ready < 0 ? -1 : ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (length > 0) {
      rest_.append(bytes.data(), static_cast<std::size_t>(length));
    } else if (length == 0 || errno != EINTR) {
      has_ended_ = true;
    }
  }
  return Wait::line;
}

std::string InputLines::take() {
  const std::size_t end = rest_.find('\n');
  std::string line = rest_.substr(0, end);
  rest_.erase(0, end == std::string::npos ? end : end + 1);
  return line;
}

SeatSettings read_seat_settings(InputLines& lines) {
  const json line =
      lines.wait(settings_patience_ms) == InputLines::Wait::line ? json::parse(lines.take(), nullptr, false) : json();
  const auto token = host::AccessToken::parse(line.is_object() ? line.value("token", "") : "");
  if (!token) {
    throw BadInput("--seat: found no settings on standard input, expected those that 'proleg ui --class' gives");
  }
  return {*token,
          line.value("name", ""),
          line.value("is_teacher", false),
          line.value("may_write_code", false),
          line.value("is_open_to_network", false),
          limits_in(line.value("limits", json())),
          line.value("page_program", "")};
}

SeatInput::SeatInput(const SeatSettings& settings, InputLines& lines, host::WebServer& page)
    : lines_(lines), page_(page) {
  page_.publish("seat",
                {{"name", settings.name}, {"is_teacher", settings.is_teacher}, {"has_modules", settings.is_teacher}});
  page_.publish("handed_out", json::array());
  print({{"port", page_.port()}});
  thread_ = std::thread([this] { run(); });
}

SeatInput::~SeatInput() {
  ends_ = true;
  thread_.join();
}

void SeatInput::run() {
  json handed_out = json::array();
  unsigned handed_number = 0;
  while (!ends_) {
    const InputLines::Wait found = lines_.wait(look_period_ms);
    if (found == InputLines::Wait::end) {
      std::raise(SIGTERM);  // the class has ended
      return;
    }
    if (found == InputLines::Wait::line) {
      take_line(lines_.take(), handed_out, handed_number);
    }
  }
}

void SeatInput::take_line(const std::string& line, json& handed_out, unsigned& handed_number) {
  const json message = json::parse(line, nullptr, false);
  const std::string what = message.is_object() ? message.value("do", "") : "";
  if (what == "stop") {
    page_.stop_robot(message.value("by", ""),
                     [number = message.value("number", std::uint64_t{0})](unsigned confirmed, unsigned of) {
                       print({{"stopped", number}, {"confirmed", confirmed}, {"of", of}});
                     });
  } else if (what == "notice") {
    page_.notice(host::NoticeLevel::info, message.value("text", ""));
  } else if (what == "hand_out") {
    ++handed_number;
    handed_out.push_back(
        {{"number", handed_number}, {"file", message.value("file", "")}, {"title", message.value("title", "")}});
    if (handed_out.size() > most_handed_out) {
      handed_out.erase(handed_out.begin());
    }
    page_.publish("handed_out", handed_out);
  }
}

}  // namespace proleg::tools
