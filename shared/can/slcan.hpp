#pragma once

// slcan: CAN over a serial line as lines of ASCII text. Sources: the manual of LAWICEL's CANUSB (frames, commands, time
// stamps); Linux, drivers/net/can/slcan (the lines `s` and `e`). docs/adapters.md describes the part that Proleg's
// adapters support.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "shared/can/can_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg {

/// The character that ends a line.
inline constexpr char slcan_end = '\r';
/// The answer of an adapter to a line that it rejects. This character ends a line, too.
inline constexpr char slcan_reject = '\a';

/// Length of the longest line without its end: an extended frame with 8 bytes and a time stamp.
inline constexpr std::size_t slcan_max_line = 1 + 8 + 1 + 16 + 4;

/// A classic CAN frame of any kind, as a line of slcan carries it.
struct SlcanFrame {
  static constexpr std::uint32_t max_extended_identifier = 0x1FFF'FFFF;
  static constexpr std::uint16_t milliseconds = 60'000;  ///< a time stamp counts from 0 to 59,999 and starts again

  std::uint32_t identifier = 0;        ///< 0 to 0x7FF, or to 0x1FFFFFFF if it is extended
  bool is_extended = false;            ///< whether the identifier has 29 bits
  bool is_remote = false;              ///< whether it is a request for data, with a length but no data
  std::uint8_t length = 0;             ///< number of data bytes, 0 to 8
  std::array<std::uint8_t, 8> data{};  ///< bytes from `length` on are 0
  std::optional<std::uint16_t> timestamp_ms;

  /// Whether it is a standard data frame; Proleg's protocol has no others.
  [[nodiscard]] bool is_for_protocol() const { return !is_extended && !is_remote; }
  /// The frame for the bus; is_for_protocol() must hold.
  [[nodiscard]] CanFrame can_frame() const { return {static_cast<std::uint16_t>(identifier), length, data}; }

  friend bool operator==(const SlcanFrame&, const SlcanFrame&) = default;
};

[[nodiscard]] SlcanFrame slcan_frame(const CanFrame& frame, std::optional<std::uint16_t> timestamp_ms = std::nullopt);

/// The text of a line, without its end unless a function says otherwise.
class SlcanText {
 public:
  static constexpr std::size_t capacity = slcan_max_line + 2;

  constexpr SlcanText() = default;
  /// Takes the first `capacity` characters of `text`.
  explicit constexpr SlcanText(std::string_view text) { append(text); }

  constexpr void append(char character) {
    if (size_ < capacity) {
      characters_[size_++] = character;
    }
  }
  constexpr void append(std::string_view text) {
    for (const char character : text) {
      append(character);
    }
  }
  [[nodiscard]] constexpr std::string_view view() const { return {characters_.data(), size_}; }

 private:
  std::array<char, capacity> characters_{};
  std::size_t size_ = 0;
};

/// Reads a line that begins with t, T, r or R, with or without a time stamp. Hexadecimal digits may have either case.
/// Nothing if a digit is missing, superfluous or wrong, or a number is out of range.
[[nodiscard]] std::optional<SlcanFrame> parse_slcan_frame(std::string_view line);
/// Number of characters from the begin of a frame's line to the last data byte: adapters append digits to it. 0 if the
/// line does not begin as that of a frame. The characters may be missing.
[[nodiscard]] std::size_t slcan_frame_size(std::string_view line);
/// Writes the line of a frame, with upper-case digits.
[[nodiscard]] SlcanText format_slcan_frame(const SlcanFrame& frame);

/// Reads the line of an error state: `s`, a letter for the state (a, w, p, b), and the receive and the transmit error
/// counter with three decimal digits each. format_slcan_status() writes larger counters as 999.
[[nodiscard]] std::optional<CanStatus> parse_slcan_status(std::string_view line);
[[nodiscard]] SlcanText format_slcan_status(const CanStatus& status);

/// Reads the line of errors: `e`, the number of letters that follow, and a letter for each kind of error (a, b, B, c,
/// f, o, O, s), at most 8.
[[nodiscard]] std::optional<CanErrors> parse_slcan_errors(std::string_view line);
/// Writes the line of errors, with each letter once, in the order of CanErrorKind.
[[nodiscard]] SlcanText format_slcan_errors(CanErrors errors);

/// Assembles received characters to lines.
class SlcanLineReader {
 public:
  enum class Event : std::uint8_t {
    none,      ///< the line is not complete
    line,      ///< line() is complete; it may be empty
    rejected,  ///< BEL was received after the characters of line(); mostly there are none
    too_long,  ///< a line with more than slcan_max_line characters has ended; they were dropped
  };

  Event push(char character);
  /// The line that was received; valid after `line` and `rejected`, until the next push().
  [[nodiscard]] std::string_view line() const { return line_.view(); }
  /// Drops the characters of a line that is not complete.
  void reset();

 private:
  SlcanText line_;
  bool has_ended_ = false;
  bool is_too_long_ = false;
};

}  // namespace proleg
