#include "host/transport/slcan_adapter_lines.hpp"

#include <algorithm>
#include <array>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

constexpr std::size_t max_line = 200;      // characters; longer than any known answer to V
constexpr std::size_t sample_length = 40;  // characters in an error

constexpr std::string_view hexadecimal_digits = "0123456789ABCDEFabcdef";

}  // namespace

bool begins_with_z(std::string_view line) { return !line.empty() && (line.front() == 'z' || line.front() == 'Z'); }

std::string printable_bytes(std::string_view bytes) {
  std::string text;
  for (const char character : bytes.substr(0, sample_length)) {
    if (character == '\r') {
      text += "\\r";
    } else if (character == '\n') {
      text += "\\n";
    } else if (character == '\a') {
      text += "\\a";
    } else if (character >= ' ' && character <= '~') {
      text += character;
    } else {
      text += "\\x" + hexadecimal(static_cast<unsigned char>(character), 2).substr(2);
    }
  }
  return "'" + text + (bytes.size() > sample_length ? "...'" : "'");
}

SlcanAdapterLines::Event SlcanAdapterLines::push(char character) {
  if (has_ended_) {
    line_.clear();
    has_ended_ = false;
  }
  const bool is_lf_cr = has_ended_with_lf_ && character == slcan_end;
  has_ended_with_lf_ = character == '\n' && !line_.empty();
  if (is_lf_cr || (character == '\n' && line_.empty())) {
    return Event::none;  // the second character of CR LF or LF CR
  }
  if (character == slcan_end || character == slcan_reject || character == '\n') {
    has_ended_ = true;
    return character == slcan_reject ? Event::rejected : Event::line;
  }
  if (line_.size() < max_line) {
    line_ += character;
  }
  has_ended_ = has_bare_z_ && line_.size() == 1 && begins_with_z(line_);
  return has_ended_ ? Event::line : Event::none;
}

std::optional<SlcanFrame> SlcanAdapterLines::read_frame(std::string_view line) {
  constexpr std::array<std::size_t, 6> possible{0, 1, 4, 5, 8, 9};
  const std::size_t size = std::min(slcan_frame_size(line), line.size());
  const std::string_view appended = line.substr(size);
  if (std::ranges::find(possible, appended.size()) == possible.end() ||
      appended.find_first_not_of(hexadecimal_digits) != std::string_view::npos) {
    return std::nullopt;
  }
  const auto frame = parse_slcan_frame(line.substr(0, size));
  if (!frame) {
    return std::nullopt;
  }
  const bool is_usual = appended.size() % 2 == 0 || last_appended_.value_or(appended.size()) == appended.size();
  last_appended_ = appended.size();
  return is_usual ? frame : std::nullopt;
}

}  // namespace proleg::host
