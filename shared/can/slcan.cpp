#include "shared/can/slcan.hpp"

namespace proleg {
namespace {

constexpr std::string_view frame_letters = "trTR";
constexpr std::size_t standard_digits = 3;
constexpr std::size_t extended_digits = 8;
constexpr std::size_t timestamp_digits = 4;
constexpr std::size_t counter_digits = 3;
constexpr std::string_view state_letters = "awpb";      // in the order of CanState
constexpr std::string_view error_letters = "abBcfoOs";  // in the order of CanErrorKind

/// Removes the first characters. substr() may throw, and the images of the modules contain no exceptions.
std::string_view without_first(std::string_view text, std::size_t count) {
  text.remove_prefix(count);
  return text;
}

std::optional<unsigned> digit_value(char character) {
  if (character >= '0' && character <= '9') {
    return static_cast<unsigned>(character - '0');
  }
  if (character >= 'A' && character <= 'F') {
    return static_cast<unsigned>(character - 'A') + 10U;
  }
  if (character >= 'a' && character <= 'f') {
    return static_cast<unsigned>(character - 'a') + 10U;
  }
  return std::nullopt;
}

/// Reads numbers from the left end of a text.
class Digits {
 public:
  explicit Digits(std::string_view text) : text_(text) {}

  /// Takes the next `count` digits as a number; nothing if they are missing.
  std::optional<std::uint32_t> take(std::size_t count, unsigned base) {
    if (text_.size() < count) {
      return std::nullopt;
    }
    std::uint32_t number = 0;
    for (const char character : std::string_view(text_.data(), count)) {
      const std::optional<unsigned> value = digit_value(character);
      if (!value || *value >= base) {
        return std::nullopt;
      }
      number = number * base + *value;
    }
    text_.remove_prefix(count);
    return number;
  }
  [[nodiscard]] bool empty() const { return text_.empty(); }

 private:
  std::string_view text_;
};

void append_digits(SlcanText& text, std::uint32_t number, std::size_t count, unsigned base) {
  std::array<char, 8> digits{};
  for (std::size_t i = count; i > 0; --i) {
    digits[i - 1] = "0123456789ABCDEF"[number % base];
    number /= base;
  }
  text.append(std::string_view(digits.data(), count));
}

}  // namespace

SlcanFrame slcan_frame(const CanFrame& frame, std::optional<std::uint16_t> timestamp_ms) {
  return {frame.identifier, false, false, frame.length, frame.data, timestamp_ms};
}

std::optional<SlcanFrame> parse_slcan_frame(std::string_view line) {
  const std::size_t kind = line.empty() ? std::string_view::npos : frame_letters.find(line.front());
  if (kind == std::string_view::npos) {
    return std::nullopt;
  }
  SlcanFrame frame;
  frame.is_extended = kind >= 2;
  frame.is_remote = kind % 2 == 1;
  Digits digits(without_first(line, 1));
  const auto identifier = digits.take(frame.is_extended ? extended_digits : standard_digits, 16);
  const auto length = digits.take(1, 10);
  const std::uint32_t largest = frame.is_extended ? SlcanFrame::max_extended_identifier : CanFrame::max_identifier;
  if (!identifier || *identifier > largest || !length || *length > CanFrame::max_length) {
    return std::nullopt;
  }
  frame.identifier = *identifier;
  frame.length = static_cast<std::uint8_t>(*length);
  for (std::size_t i = 0; !frame.is_remote && i < frame.length; ++i) {
    const auto byte = digits.take(2, 16);
    if (!byte) {
      return std::nullopt;
    }
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  if (!digits.empty()) {
    const auto timestamp = digits.take(timestamp_digits, 16);
    if (!timestamp || *timestamp >= SlcanFrame::milliseconds || !digits.empty()) {
      return std::nullopt;
    }
    frame.timestamp_ms = static_cast<std::uint16_t>(*timestamp);
  }
  return frame;
}

std::size_t slcan_frame_size(std::string_view line) {
  const std::size_t kind = line.empty() ? std::string_view::npos : frame_letters.find(line.front());
  if (kind == std::string_view::npos) {
    return 0;
  }
  const std::size_t head = 1 + (kind >= 2 ? extended_digits : standard_digits) + 1;
  const std::optional<unsigned> length = line.size() < head ? std::nullopt : digit_value(line[head - 1]);
  return length ? head + (kind % 2 == 1 ? 0U : 2U * *length) : 0U;
}

SlcanText format_slcan_frame(const SlcanFrame& frame) {
  SlcanText text;
  const std::size_t letter = (frame.is_extended ? 2U : 0U) + (frame.is_remote ? 1U : 0U);
  text.append(frame_letters[letter]);
  append_digits(text, frame.identifier, frame.is_extended ? extended_digits : standard_digits, 16);
  append_digits(text, frame.length, 1, 10);
  for (std::size_t i = 0; !frame.is_remote && i < frame.length && i < frame.data.size(); ++i) {
    append_digits(text, frame.data[i], 2, 16);
  }
  if (frame.timestamp_ms) {
    append_digits(text, *frame.timestamp_ms, timestamp_digits, 16);
  }
  return text;
}

std::optional<CanStatus> parse_slcan_status(std::string_view line) {
  if (line.size() != 2 + 2 * counter_digits || line.front() != 's') {
    return std::nullopt;
  }
  const std::size_t state = state_letters.find(line[1]);
  Digits digits(without_first(line, 2));
  const auto receive = digits.take(counter_digits, 10);
  const auto transmit = digits.take(counter_digits, 10);
  if (state == std::string_view::npos || !receive || !transmit) {
    return std::nullopt;
  }
  return CanStatus{static_cast<CanState>(state), static_cast<std::uint16_t>(*receive),
                   static_cast<std::uint16_t>(*transmit)};
}

SlcanText format_slcan_status(const CanStatus& status) {
  constexpr std::uint16_t largest = 999;
  SlcanText text;
  text.append('s');
  text.append(state_letters[static_cast<std::size_t>(status.state)]);
  for (const std::uint16_t counter : {status.receive_errors, status.transmit_errors}) {
    append_digits(text, counter < largest ? counter : largest, counter_digits, 10);
  }
  return text;
}

std::optional<CanErrors> parse_slcan_errors(std::string_view line) {
  if (line.size() < 2 || line.front() != 'e') {
    return std::nullopt;
  }
  const std::optional<unsigned> count = digit_value(line[1]);
  if (!count || *count > can_error_kinds || line.size() != 2 + *count) {
    return std::nullopt;
  }
  CanErrors errors;
  for (const char letter : without_first(line, 2)) {
    const std::size_t kind = error_letters.find(letter);
    if (kind == std::string_view::npos) {
      return std::nullopt;
    }
    errors.add(static_cast<CanErrorKind>(kind));
  }
  return errors;
}

SlcanText format_slcan_errors(CanErrors errors) {
  SlcanText letters;
  for (std::size_t kind = 0; kind < can_error_kinds; ++kind) {
    if (errors.contains(static_cast<CanErrorKind>(kind))) {
      letters.append(error_letters[kind]);
    }
  }
  SlcanText text;
  text.append('e');
  append_digits(text, static_cast<std::uint32_t>(letters.view().size()), 1, 10);
  text.append(letters.view());
  return text;
}

SlcanLineReader::Event SlcanLineReader::push(char character) {
  if (has_ended_) {
    reset();
  }
  if (character == slcan_end || character == slcan_reject) {
    has_ended_ = true;
    if (is_too_long_) {
      line_ = {};
      return Event::too_long;
    }
    return character == slcan_end ? Event::line : Event::rejected;
  }
  if (character == '\n' && line_.view().empty() && !is_too_long_) {
    return Event::none;  // the LF of a program that ends lines with CR LF
  }
  if (line_.view().size() == slcan_max_line) {
    is_too_long_ = true;
  } else {
    line_.append(character);
  }
  return Event::none;
}

void SlcanLineReader::reset() {
  line_ = {};
  has_ended_ = false;
  is_too_long_ = false;
}

}  // namespace proleg
