#pragma once

// Functions that read and write text.

#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace proleg {

/// Number of bytes of the UTF-8 character at the start of `text`; 0 if there is no valid one.
[[nodiscard]] std::size_t utf8_character_size(std::string_view text);

/// Position of the first byte that is not UTF-8.
[[nodiscard]] std::optional<std::size_t> find_invalid_utf8(std::string_view text);

/// The text with control characters and line separators replaced by blanks, and bytes that are not UTF-8 by '?'.
[[nodiscard]] std::string one_line(std::string_view text);

/// The first characters of a text, with "..." if there are more. It is for text of the input within a message or a
/// picture.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t max_characters = 60);

/// The text, shortened to 60 characters, between single quotes. Characters that nobody sees, such as a no-break space
/// or a zero-width one, are shown by their numbers: <U+00A0>.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// Whether one_line() and in_quotes() show the whole text as it is: one line of valid UTF-8 of which a person sees
/// every character, blanks included. Names that people compare should be such texts.
[[nodiscard]] bool is_visible_line(std::string_view text);

/// The text with ASCII letters in lower case. XML tags and attributes are compared in this form.
[[nodiscard]] std::string lower_case(std::string_view text);

/// The text without blanks at both ends. Blanks are those of XML: space, tab and line ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The text behind the byte order mark that some editors put in front of UTF-8.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

/// The text as content of an XML element, or of an attribute between double quotes.
[[nodiscard]] std::string escaped_xml(std::string_view text);

/// The words of a text that blanks separate.
[[nodiscard]] std::vector<std::string_view> words(std::string_view text);

/// The lines of a text that a person writes, one after the other, without the byte order mark of an editor and without
/// line ends. Lines end with "\n" or "\r\n". The text must outlive the object.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : rest_(without_byte_order_mark(text)) {}
  /// The next line; nothing behind the last one.
  [[nodiscard]] std::optional<std::string_view> next();
  /// Number of the line that next() has given, from 1.
  [[nodiscard]] int number() const { return number_; }

 private:
  std::string_view rest_;
  int number_ = 0;
};

/// The items as a list: "a, b, c"; at most 30 items, then "...". "nothing" for an empty list.
[[nodiscard]] std::string listed(std::span<const std::string> items);

/// The known word that is most similar to a word, for a hint: the fewest letters must be inserted, removed, replaced or
/// exchanged with their neighbour. Nothing if that takes more than a third of the letters.
[[nodiscard]] std::optional<std::string> most_similar(std::string_view word, std::span<const std::string> known);

/// The integer that is the whole text, without blanks and, for an unsigned type, without a sign. Nothing if the text is
/// no such number or the number does not fit.
template <typename Integer>
[[nodiscard]] std::optional<Integer> parse_whole(std::string_view text, int base = 10) {
  Integer value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return text.empty() || error != std::errc{} || end != text.data() + text.size() ? std::nullopt
                                                                                  : std::optional<Integer>(value);
}

/// The finite decimal number that is the whole word, with or without a sign; nothing for anything else.
[[nodiscard]] std::optional<double> parse_number(std::string_view word);

/// A probability, 0 to 1 or 0% to 100%, times 2^32 (at most 2^32 - 1); nothing for anything else.
[[nodiscard]] std::optional<std::uint32_t> parse_rate(std::string_view text);

/// A short text of a number, for messages.
[[nodiscard]] std::string number_text(double value);

/// The shortest text that reads back as the same number; empty if it is not finite.
[[nodiscard]] std::string exact_text(double value);

/// A hexadecimal number such as "0x1F", with at least `min_digits` digits.
[[nodiscard]] std::string hexadecimal(std::uint32_t value, unsigned min_digits = 1);

/// The cells of a line of a tab-separated table; one for an empty line.
[[nodiscard]] std::vector<std::string_view> cells_of(std::string_view line);

/// A line of a tab-separated table. Its first cell is not empty.
class TableLine {
 public:
  void add(std::string_view cell) {
    if (!text_.empty()) {
      text_ += '\t';
    }
    text_ += cell;
  }
  void add(const char* cell) { add(std::string_view(cell)); }
  /// Appends a cell with a number; the cell is empty if the number is not finite.
  template <std::floating_point Number>
  void add(Number value) {
    add(std::string_view(exact_text(value)));
  }
  template <std::unsigned_integral Number>
  void add(Number value) {
    add(std::string_view(std::to_string(value)));
  }

  /// Returns the cells and a line end; then starts an empty line.
  [[nodiscard]] std::string finish() { return std::exchange(text_, {}) + '\n'; }

 private:
  std::string text_;
};

}  // namespace proleg
