#pragma once

// Reading and writing of text that several rooms share.

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg {

/// Bytes of the UTF-8 character at the start of `text`, or 0 if there is none.
[[nodiscard]] std::size_t utf8_character_size(std::string_view text);

/// Position of the first byte that is not UTF-8.
[[nodiscard]] std::optional<std::size_t> find_invalid_utf8(std::string_view text);

/// The text with control characters and line separators replaced by blanks, and bytes that are not UTF-8 by '?'.
[[nodiscard]] std::string one_line(std::string_view text);

/// The first characters, with "..." if there are more. For text of the input within a message or a picture.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t max_characters = 60);

/// Shortened to 60 characters and between single quotes.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// ASCII letters in lower case. XML tags and attributes are compared this way.
[[nodiscard]] std::string lower_case(std::string_view text);

/// Without blanks at both ends. Blanks are those of XML: space, tab and line ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The text behind the byte order mark that some editors put in front of UTF-8.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

/// The words between blanks.
[[nodiscard]] std::vector<std::string_view> words(std::string_view text);

/// "a, b, c"; at most 30 items, then "...". "nothing" for an empty list.
[[nodiscard]] std::string listed(std::span<const std::string> items);

/// The known word that is most like a word, for a hint: the one with the fewest letters inserted, removed, replaced or
/// exchanged with their neighbour. Nothing if that takes more than a third of the letters.
[[nodiscard]] std::optional<std::string> most_similar(std::string_view word, std::span<const std::string> known);

/// The whole text as an integer, without blanks and, for an unsigned type, without a sign. Nothing if the text is no
/// such number or the number does not fit.
template <typename Integer>
[[nodiscard]] std::optional<Integer> parse_whole(std::string_view text, int base = 10) {
  Integer value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return text.empty() || error != std::errc{} || end != text.data() + text.size() ? std::nullopt
                                                                                  : std::optional<Integer>(value);
}

/// The whole word as a finite decimal number, or nothing.
[[nodiscard]] std::optional<double> parse_number(std::string_view word);

/// A probability, 0 to 1 or 0% to 100%, times 2^32 (at most 2^32 - 1); nothing for anything else.
[[nodiscard]] std::optional<std::uint32_t> parse_rate(std::string_view text);

/// Short text of a number for messages.
[[nodiscard]] std::string number_text(double value);

/// Shortest text that reads back as the same number; empty if it is not finite.
[[nodiscard]] std::string exact_text(double value);

/// "0x1F", with at least that many digits.
[[nodiscard]] std::string hexadecimal(std::uint32_t value, unsigned min_digits = 1);

}  // namespace proleg
