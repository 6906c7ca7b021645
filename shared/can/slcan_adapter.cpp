#include "shared/can/slcan_adapter.hpp"

#include <algorithm>

namespace proleg {
namespace {

using namespace std::string_view_literals;  // no strlen() in the image of the modules

constexpr std::uint16_t sync_identifier = 0x080;
constexpr std::uint32_t microseconds_per_millisecond = 1'000;

// Status flags that command F reports (LAWICEL's manual).
constexpr unsigned flag_receive_full = 1U << 0U;
constexpr unsigned flag_transmit_full = 1U << 1U;
constexpr unsigned flag_error_warning = 1U << 2U;
constexpr unsigned flag_overrun = 1U << 3U;
constexpr unsigned flag_error_passive = 1U << 5U;
constexpr unsigned flag_bus_error = 1U << 7U;

/// The answer of a line that was accepted: CR alone.
std::optional<SlcanText> accepted() { return SlcanText(); }

bool is_state_frame(std::uint16_t identifier) {
  const unsigned base = identifier & 0x780U;
  return (base == 0x180U || base == 0x280U) && identifier != base;
}

std::uint16_t timestamp_of(Microseconds now) {
  return static_cast<std::uint16_t>(now / microseconds_per_millisecond % SlcanFrame::milliseconds);
}

void append_hexadecimal(SlcanText& text, unsigned value, unsigned digits) {
  for (unsigned i = digits; i > 0; --i) {
    text.append("0123456789ABCDEF"[value >> (4U * (i - 1U)) & 0xFU]);
  }
}

}  // namespace

void SlcanAdapter::input(std::string_view characters) {
  for (const char character : characters) {
    switch (reader_.push(character)) {
      case SlcanLineReader::Event::none:
        break;
      case SlcanLineReader::Event::line:
      case SlcanLineReader::Event::rejected:
        execute(reader_.line());
        break;
      case SlcanLineReader::Event::too_long:
        execute("too long"sv);  // no command begins so: the line is rejected
        break;
    }
  }
}

void SlcanAdapter::execute(std::string_view line) {
  if (line.empty()) {
    return;  // programs send empty lines to end a line that they have begun before
  }
  const bool was_open = is_open();
  const std::optional<SlcanText> text = answer(line);
  const bool is_written =
      text ? write(text->view(), slcan_end, Importance::answer) : write({}, slcan_reject, Importance::answer);
  counters_.answers_dropped += is_written ? 0U : 1U;
  if (is_open() && !was_open) {
    status_is_pending_ = status_.state != CanState::error_active;
    write_pending_status();
  }
}

std::optional<SlcanText> SlcanAdapter::answer(std::string_view line) {
  switch (line.front()) {
    case 't':
    case 'T':
    case 'r':
    case 'R':
      return answer_frame(line);
    case 'S':
      return line == "S8"sv && !is_open() ? accepted() : rejected();
    case 'O':
      return line == "O"sv ? open(Mode::normal) : rejected();
    case 'L':
      return line == "L"sv ? open(Mode::listen_only) : rejected();
    case 'C':
      if (line != "C"sv) {
        return rejected();
      }
      mode_ = Mode::closed;
      return accepted();
    case 'Z':
      if (line != "Z0"sv && line != "Z1"sv) {
        return rejected();
      }
      has_timestamps_ = line == "Z1"sv;
      return accepted();
    case 'X':  // automatic sending of received frames cannot be switched off
      return line == "X1"sv ? accepted() : rejected();
    case 'F':
      return line == "F"sv ? std::optional(status_flags()) : rejected();
    case 'V': {
      if (line != "V"sv) {
        return rejected();
      }
      SlcanText text("V"sv);
      append_hexadecimal(text, settings_.version, 4);
      return text;
    }
    case 'N': {
      if (line != "N"sv) {
        return rejected();
      }
      SlcanText text("N"sv);
      text.append(std::string_view(settings_.serial_number.data(), settings_.serial_number.size()));
      return text;
    }
    default:
      return rejected();
  }
}

std::optional<SlcanText> SlcanAdapter::rejected() {
  ++counters_.lines_rejected;
  return std::nullopt;
}

std::optional<SlcanText> SlcanAdapter::open(Mode mode) {
  if (is_open()) {
    return rejected();
  }
  mode_ = mode;
  return accepted();
}

std::optional<SlcanText> SlcanAdapter::answer_frame(std::string_view line) {
  const std::optional<SlcanFrame> frame = parse_slcan_frame(line);
  if (!frame) {
    return rejected();
  }
  const bool can_be_sent = mode_ == Mode::normal && frame->is_for_protocol();
  if (!can_be_sent || !bus_.send(frame->can_frame())) {
    flags_ = static_cast<std::uint8_t>(flags_ | (can_be_sent ? flag_transmit_full : 0U));
    ++counters_.frames_refused;
    return std::nullopt;
  }
  ++counters_.frames_sent;
  return SlcanText("z"sv);
}

SlcanText SlcanAdapter::status_flags() {
  unsigned flags = flags_;
  flags_ = 0;
  switch (status_.state) {
    case CanState::error_active:
      break;
    case CanState::error_warning:
      flags |= flag_error_warning;
      break;
    case CanState::error_passive:
      flags |= flag_error_warning | flag_error_passive;
      break;
    case CanState::bus_off:
      flags |= flag_error_warning | flag_error_passive | flag_bus_error;
      break;
  }
  SlcanText text("F"sv);
  append_hexadecimal(text, flags, 2);
  return text;
}

void SlcanAdapter::received(Microseconds now, const CanFrame& frame) {
  if (!is_open()) {
    return;
  }
  if (frame.identifier == sync_identifier && settings_.state_frame_divisor > 1) {
    syncs_ = static_cast<std::uint8_t>((syncs_ + 1U) % settings_.state_frame_divisor);
  }
  const bool is_state = is_state_frame(frame.identifier);
  if (is_state && syncs_ != 0) {
    ++counters_.state_frames_thinned;
    return;
  }
  const auto timestamp = has_timestamps_ ? std::optional(timestamp_of(now)) : std::nullopt;
  const SlcanText text = format_slcan_frame(slcan_frame(frame, timestamp));
  if (write(text.view(), slcan_end, is_state ? Importance::state_frame : Importance::frame)) {
    ++counters_.frames_received;
  } else {
    ++(is_state ? counters_.state_frames_dropped : counters_.frames_dropped);
    flags_ = static_cast<std::uint8_t>(flags_ | flag_receive_full);
  }
}

void SlcanAdapter::status_changed(const CanStatus& status) {
  status_is_pending_ = status_is_pending_ || status.state != status_.state;
  status_ = status;
  write_pending_status();
}

void SlcanAdapter::errors_occurred(CanErrors errors) {
  if (errors.empty()) {
    return;
  }
  const unsigned overrun = errors.contains(CanErrorKind::receive_overrun) ? flag_overrun : 0U;
  flags_ = static_cast<std::uint8_t>(flags_ | flag_bus_error | overrun);
  if (is_open() && !write(format_slcan_errors(errors).view(), slcan_end, Importance::frame)) {
    ++counters_.frames_dropped;
  }
}

std::size_t SlcanAdapter::take(std::span<char> characters) {
  const std::size_t count = std::min(characters.size(), size_);
  for (std::size_t i = 0; i < count; ++i) {
    characters[i] = buffer_[first_];
    first_ = first_ + 1 == buffer_.size() ? 0 : first_ + 1;
  }
  size_ -= count;
  write_pending_status();
  return count;
}

void SlcanAdapter::reset() {
  reader_.reset();
  first_ = 0;
  size_ = 0;
  syncs_ = 0;
  flags_ = 0;
  mode_ = Mode::closed;
  has_timestamps_ = false;
  status_is_pending_ = false;
}

void SlcanAdapter::write_pending_status() {
  // Only the latest state waits for room in the output.
  if (is_open() && status_is_pending_ && write(format_slcan_status(status_).view(), slcan_end, Importance::answer)) {
    status_is_pending_ = false;
  }
}

bool SlcanAdapter::write(std::string_view line, char end, Importance importance) {
  std::size_t reserve = 0;
  if (importance == Importance::state_frame) {
    reserve = buffer_.size() / 4;
  } else if (importance == Importance::frame) {
    reserve = answer_reserve;
  }
  const std::size_t length = line.size() + 1;
  if (size_ + length + reserve > buffer_.size()) {
    return false;
  }
  std::size_t position = first_ + size_;
  for (std::size_t i = 0; i < length; ++i, ++position) {
    buffer_[position < buffer_.size() ? position : position - buffer_.size()] = i < line.size() ? line[i] : end;
  }
  size_ += length;
  return true;
}

}  // namespace proleg
