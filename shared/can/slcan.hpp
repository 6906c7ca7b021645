#pragma once

// slcan: CAN over a serial line as lines of ASCII text. Sources: the manual of LAWICEL's CANUSB (frames, commands, time
// stamps); Linux, drivers/net/can/slcan (the lines `s` and `e`). docs/adapters.md describes what Proleg's adapters
// speak.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "shared/can/can_frame.hpp"
#include "shared/can/can_status.hpp"

namespace proleg {

/// Ends a line.
inline constexpr char slcan_end = '\r';
/// The answer of an adapter to a line that it rejects. It ends a line, too.
inline constexpr char slcan_reject = '\a';

/// The longest line without its end: an extended frame with 8 bytes and a time stamp.
inline constexpr std::size_t slcan_max_line = 1 + 8 + 1 + 16 + 4;

/// Any classic CAN frame, as slcan carries it.
struct SlcanFrame {
  static constexpr std::uint32_t max_extended_identifier = 0x1FFF'FFFF;
  static constexpr std::uint16_t milliseconds = 60'000;  ///< time stamps count from 0 to 59,999 and start again

  std::uint32_t identifier = 0;        ///< 0 to 0x7FF, or to 0x1FFFFFFF if it is extended
  bool is_extended = false;            ///< with a 29-bit identifier
  bool is_remote = false;              ///< a request for data; it has a length but no data
  std::uint8_t length = 0;             ///< 0 to 8
  std::array<std::uint8_t, 8> data{};  ///< bytes from `length` on are 0
  std::optional<std::uint16_t> timestamp_ms;

  /// A standard data frame; Proleg's protocol has no others.
  [[nodiscard]] bool is_for_protocol() const { return !is_extended && !is_remote; }
  /// Only of a frame for which is_for_protocol() holds.
  [[nodiscard]] CanFrame can_frame() const { return {static_cast<std::uint16_t>(identifier), length, data}; }

  friend bool operator==(const SlcanFrame&, const SlcanFrame&) = default;
};

[[nodiscard]] SlcanFrame slcan_frame(const CanFrame& frame, std::optional<std::uint16_t> timestamp_ms = std::nullopt);

/// A line, without its end unless a function says otherwise.
class SlcanText {
 public:
  static constexpr std::size_t capacity = slcan_max_line + 2;

  constexpr SlcanText() = default;
  /// The first `capacity` characters.
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

/// A line that begins with t, T, r or R, with or without a time stamp. Hexadecimal digits may have either case. Nothing
/// if a digit is missing, superfluous or wrong, or a number is out of range.
[[nodiscard]] std::optional<SlcanFrame> parse_slcan_frame(std::string_view line);
/// The inverse, with upper-case digits.
[[nodiscard]] SlcanText format_slcan_frame(const SlcanFrame& frame);

/// `s`, a letter for the state (a, w, p, b), and the receive and the transmit error counter with three decimal digits
/// each; format writes larger counters as 999.
[[nodiscard]] std::optional<CanStatus> parse_slcan_status(std::string_view line);
[[nodiscard]] SlcanText format_slcan_status(const CanStatus& status);

/// `e`, how many letters follow, and a letter for each kind of error (a, b, B, c, f, o, O, s), at most 8.
[[nodiscard]] std::optional<CanErrors> parse_slcan_errors(std::string_view line);
/// The inverse, with each letter once, in the order of CanErrorKind.
[[nodiscard]] SlcanText format_slcan_errors(CanErrors errors);

/// Puts received characters together to lines.
class SlcanLineReader {
 public:
  enum class Event : std::uint8_t {
    none,      ///< the line goes on
    line,      ///< line() is complete; it may be empty
    rejected,  ///< BEL, after the characters of line(); mostly there are none
    too_long,  ///< the end of a line with more than slcan_max_line characters, which were dropped
  };

  Event push(char character);
  /// After `line` and `rejected`, until the next push().
  [[nodiscard]] std::string_view line() const { return line_.view(); }
  /// Forgets a line that has begun.
  void reset();

 private:
  SlcanText line_;
  bool has_ended_ = false;
  bool is_too_long_ = false;
};

}  // namespace proleg
