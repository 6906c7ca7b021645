#include "tools/proleg/ui/compiler_messages.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

using Severity = CompilerMessage::Severity;

constexpr std::size_t most_messages = 200;
constexpr std::size_t longest_text = 400;

constexpr std::array<std::pair<std::string_view, Severity>, 4> severities{{{" fatal error: ", Severity::error},
                                                                           {" error: ", Severity::error},
                                                                           {" warning: ", Severity::warning},
                                                                           {" note: ", Severity::note}}};

/// Takes ":NUMBER" from the end of a text.
std::optional<std::uint32_t> take_number(std::string_view& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) {
    return std::nullopt;
  }
  const std::optional<std::uint32_t> number = parse_whole<std::uint32_t>(text.substr(colon + 1));
  if (number) {
    text = text.substr(0, colon);
  }
  return number;
}

/// Reads "FILE:LINE:COLUMN" or "FILE:LINE" into a message; false if it is neither.
bool read_place(std::string_view place, CompilerMessage& message) {
  const std::optional<std::uint32_t> last = take_number(place);
  if (!last || place.empty()) {
    return false;
  }
  const std::optional<std::uint32_t> line = take_number(place);
  message.line = line.value_or(*last);
  message.column = line ? *last : 0;
  message.file = place;
  return !place.empty();
}

/// "FILE:LINE:COLUMN: error: TEXT"
std::optional<CompilerMessage> compiler_message(std::string_view line) {
  for (const auto& [word, severity] : severities) {
    const std::size_t at = line.find(word);
    if (at == std::string_view::npos || at == 0 || line[at - 1] != ':') {
      continue;
    }
    CompilerMessage message;
    message.severity = severity;
    message.text = line.substr(at + word.size());
    if (read_place(line.substr(0, at - 1), message)) {
      return message;
    }
  }
  return std::nullopt;
}

std::optional<CompilerMessage> linker_message(std::string_view line) {
  const std::size_t at = line.find("undefined reference to ");
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  CompilerMessage message;
  message.text = line.substr(at);
  return message;
}

/// A place in the text of an error of CMake: "found floating point (wave.cpp:12:5), expected ...".
void read_place_in_text(CompilerMessage& message) {
  const std::size_t open = message.text.find('(');
  const std::size_t close = message.text.find(')', open);
  if (close != std::string::npos) {
    const std::string place = message.text.substr(open + 1, close - open - 1);
    CompilerMessage found;
    if (read_place(place, found)) {
      message.file = found.file;
      message.line = found.line;
      message.column = found.column;
    }
  }
}

/// "CMake Error at FILE:LINE (message):", then the text in lines that begin with blanks.
std::optional<CompilerMessage> cmake_message(std::string_view line, TextLines& lines) {
  constexpr std::string_view begin = "CMake Error";
  if (!line.starts_with(begin)) {
    return std::nullopt;
  }
  CompilerMessage message;
  if (const std::size_t text = line.find(": "); line.starts_with("CMake Error:") && text != std::string_view::npos) {
    message.text = line.substr(text + 2);
    return message;
  }
  while (const std::optional<std::string_view> next = lines.next()) {
    const std::string_view words = trimmed(*next);
    if (words.empty() && !message.text.empty()) {
      break;
    }
    message.text.append(message.text.empty() ? "" : " ").append(words);
  }
  read_place_in_text(message);
  return message;
}

bool is_same(const CompilerMessage& a, const CompilerMessage& b) {
  return a.file == b.file && a.line == b.line && a.column == b.column && a.text == b.text;
}

}  // namespace

std::vector<CompilerMessage> compiler_messages(std::string_view output) {
  std::vector<CompilerMessage> messages;
  TextLines lines(output);
  while (const std::optional<std::string_view> line = lines.next()) {
    std::optional<CompilerMessage> message = compiler_message(*line);
    if (!message) {
      message = linker_message(*line);
    }
    if (!message) {
      message = cmake_message(*line, lines);
    }
    if (!message || std::ranges::any_of(messages, [&](const auto& known) { return is_same(known, *message); })) {
      continue;
    }
    message->text = shortened(one_line(message->text), longest_text);
    message->file = one_line(message->file);
    messages.push_back(std::move(*message));
    if (messages.size() == most_messages) {
      break;
    }
  }
  return messages;
}

BuildProgress build_progress(std::string_view output) {
  BuildProgress progress;
  TextLines lines(output);
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::size_t slash = line->find('/');
    const std::size_t end = line->find("] ");
    if (!line->starts_with('[') || slash == std::string_view::npos || end == std::string_view::npos || slash > end) {
      continue;
    }
    const auto done = parse_whole<std::uint32_t>(line->substr(1, slash - 1));
    const auto of = parse_whole<std::uint32_t>(line->substr(slash + 1, end - slash - 1));
    if (done && of) {
      progress = {*done, *of};
    }
  }
  return progress;
}

}  // namespace proleg::tools
