#include "sim/mcu/debug/gdb_packet.hpp"

#include <array>
#include <charconv>

namespace proleg::sim {
namespace {

constexpr char escape = '}';
constexpr unsigned escape_flip = 0x20;
constexpr char interrupt_byte = 0x03;

std::uint8_t as_byte(char character) { return static_cast<std::uint8_t>(character); }

char flipped(char character) { return static_cast<char>(as_byte(character) ^ escape_flip); }

void append_hex(std::string& text, std::uint8_t byte) {
  constexpr std::string_view digits = "0123456789abcdef";
  text += digits[byte >> 4U];
  text += digits[byte & 0xFU];
}

std::optional<std::uint8_t> hex_byte(char high, char low) {
  const std::array<char, 2> digits{high, low};
  const auto value = hex_number({digits.data(), digits.size()});
  return value ? std::optional(static_cast<std::uint8_t>(*value)) : std::nullopt;
}

}  // namespace

std::string gdb_packet(std::string_view payload) {
  std::string packet = "$";
  packet.reserve(payload.size() + 4);
  for (const char character : payload) {
    if (character == '#' || character == '$' || character == escape || character == '*') {
      packet += escape;
      packet += flipped(character);
    } else {
      packet += character;
    }
  }
  std::uint8_t sum = 0;
  for (const char character : std::string_view(packet).substr(1)) {
    sum = static_cast<std::uint8_t>(sum + as_byte(character));
  }
  packet += '#';
  append_hex(packet, sum);
  return packet;
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::uint8_t byte : bytes) {
    append_hex(text, byte);
  }
  return text;
}

std::optional<std::vector<std::uint8_t>> from_hex(std::string_view digits) {
  if (digits.size() % 2 != 0) {
    return std::nullopt;
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(digits.size() / 2);
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const auto byte = hex_byte(digits[i], digits[i + 1]);
    if (!byte) {
      return std::nullopt;
    }
    bytes.push_back(*byte);
  }
  return bytes;
}

std::optional<std::uint32_t> hex_number(std::string_view digits) {
  std::uint32_t value = 0;
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value, 16);
  return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

void GdbDecoder::feed(std::string_view bytes) {
  received_.erase(0, taken_);
  taken_ = 0;
  received_.append(bytes);
}

std::optional<GdbInput> GdbDecoder::next() {
  while (taken_ < received_.size()) {
    if (auto input = take(received_[taken_++])) {
      return input;
    }
  }
  return std::nullopt;
}

std::optional<GdbInput> GdbDecoder::take(char byte) {
  if (byte == '$') {
    state_ = State::payload;
    payload_.clear();
    escaped_ = false;
    length_ = 0;
    sum_ = 0;
    return std::nullopt;
  }
  switch (state_) {
    case State::between:
      return take_between(byte);
    case State::payload:
      take_payload(byte);
      return std::nullopt;
    case State::first_digit:
      first_digit_ = byte;
      state_ = State::second_digit;
      return std::nullopt;
    case State::second_digit:
      return finish(byte);
  }
  return std::nullopt;
}

std::optional<GdbInput> GdbDecoder::take_between(char byte) {
  switch (byte) {
    case interrupt_byte:
      return GdbInput{GdbInput::Kind::interrupt, {}};
    case '+':
      return GdbInput{GdbInput::Kind::accepted, {}};
    case '-':
      return GdbInput{GdbInput::Kind::refused, {}};
    default:
      return std::nullopt;
  }
}

void GdbDecoder::take_payload(char byte) {
  if (byte == '#') {
    state_ = State::first_digit;
    return;
  }
  sum_ = static_cast<std::uint8_t>(sum_ + as_byte(byte));
  if (++length_ > max_packet) {
    return;
  }
  if (escaped_) {
    payload_ += flipped(byte);
    escaped_ = false;
  } else if (byte == escape) {
    escaped_ = true;
  } else {
    payload_ += byte;
  }
}

GdbInput GdbDecoder::finish(char second_digit) {
  state_ = State::between;
  if (hex_byte(first_digit_, second_digit) != sum_ || escaped_) {
    return {GdbInput::Kind::damaged, {}};
  }
  if (length_ > max_packet) {
    return {GdbInput::Kind::too_long, {}};
  }
  return {GdbInput::Kind::packet, std::move(payload_)};
}

}  // namespace proleg::sim
