#include "shared/computer/text/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace proleg {
namespace {

constexpr std::string_view blanks = " \t\r\n";

unsigned byte_at(std::string_view text, std::size_t position) { return static_cast<unsigned char>(text[position]); }

/// The code point of a valid UTF-8 character.
std::uint32_t code_point_of(std::string_view character) {
  std::uint32_t code_point = byte_at(character, 0);
  if (character.size() > 1) {
    code_point &= 0x7FU >> character.size();
  }
  for (std::size_t i = 1; i < character.size(); ++i) {
    code_point = (code_point << 6U) | (byte_at(character, i) & 0x3FU);
  }
  return code_point;
}

/// Whether a character looks like a blank or like nothing, or changes the direction of the text (Unicode: general
/// categories Zs and Cf, of the basic plane, without the blank of ASCII).
bool is_invisible(std::uint32_t code_point) {
  constexpr std::pair<std::uint32_t, std::uint32_t> ranges[] = {
      {0x00A0, 0x00A0}, {0x00AD, 0x00AD}, {0x061C, 0x061C}, {0x1680, 0x1680}, {0x180E, 0x180E},
      {0x2000, 0x200F}, {0x202A, 0x202F}, {0x205F, 0x206F}, {0x3000, 0x3000}, {0xFEFF, 0xFEFF}};
  return std::ranges::any_of(
      ranges, [code_point](const auto& range) { return code_point >= range.first && code_point <= range.second; });
}

/// Whether a terminal acts on the character instead of showing it. Such are the control characters of ASCII and
/// Latin-1, the line separator and the paragraph separator.
bool breaks_a_line(std::string_view character) {
  const unsigned first = byte_at(character, 0);
  return first < 0x20 || first == 0x7F || (first == 0xC2 && byte_at(character, 1) < 0xA0) ||
         character == "\xE2\x80\xA8" || character == "\xE2\x80\xA9";
}

/// Number of letters that must be inserted, removed, replaced or exchanged with their neighbour (optimal string
/// alignment).
std::size_t distance_of(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before;
  std::vector<std::size_t> above;
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= from.size(); ++i) {
    before = std::exchange(above, row);
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (from[i - 1] == to[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
  }
  return row.back();
}

}  // namespace

std::size_t utf8_character_size(std::string_view text) {
  if (text.empty()) {
    return 0;
  }
  const unsigned first = byte_at(text, 0);
  if (first < 0x80) {
    return 1;
  }
  std::size_t size = 0;
  std::uint32_t code_point = 0;
  std::uint32_t min_code_point = 0;  // a longer form than needed is not UTF-8
  if ((first & 0xE0U) == 0xC0) {
    size = 2;
    code_point = first & 0x1FU;
    min_code_point = 0x80;
  } else if ((first & 0xF0U) == 0xE0) {
    size = 3;
    code_point = first & 0x0FU;
    min_code_point = 0x800;
  } else if ((first & 0xF8U) == 0xF0) {
    size = 4;
    code_point = first & 0x07U;
    min_code_point = 0x10000;
  }
  if (size == 0 || size > text.size()) {
    return 0;
  }
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte_at(text, i) & 0xC0U) != 0x80) {
      return 0;
    }
    code_point = (code_point << 6U) | (byte_at(text, i) & 0x3FU);
  }
  const bool surrogate = code_point >= 0xD800 && code_point <= 0xDFFF;
  return code_point < min_code_point || code_point > 0x10FFFF || surrogate ? 0 : size;
}

std::optional<std::size_t> find_invalid_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = utf8_character_size(text.substr(i));
    if (size == 0) {
      return i;
    }
    i += size;
  }
  return std::nullopt;
}

std::string one_line(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = utf8_character_size(text);
    if (size == 0) {
      result += '?';
    } else if (breaks_a_line(text.substr(0, size))) {
      result += ' ';
    } else {
      result += text.substr(0, size);
    }
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return result;
}

std::string shortened(std::string_view text, std::size_t max_characters) {
  std::size_t end = 0;
  for (std::size_t i = 0; i < max_characters && end < text.size(); ++i) {
    end += std::max<std::size_t>(utf8_character_size(text.substr(end)), 1);
  }
  return std::string(text.substr(0, end)) + (end < text.size() ? "..." : "");
}

bool is_visible_line(std::string_view text) {
  while (!text.empty()) {
    const std::string_view character = text.substr(0, utf8_character_size(text));
    if (character.empty() || breaks_a_line(character) ||
        (character.size() > 1 && is_invisible(code_point_of(character)))) {
      return false;
    }
    text.remove_prefix(character.size());
  }
  return true;
}

std::string in_quotes(std::string_view text) {
  const std::string shown = shortened(text);
  std::string result = "'";
  for (std::string_view rest = shown; !rest.empty();) {
    const std::string_view character = rest.substr(0, std::max<std::size_t>(utf8_character_size(rest), 1));
    rest.remove_prefix(character.size());
    if (character.size() > 1 && is_invisible(code_point_of(character))) {
      result += "<U+" + hexadecimal(code_point_of(character), 4).substr(2) + ">";
    } else {
      result += character;
    }
  }
  return result + "'";
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return result;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

std::optional<std::string_view> TextLines::next() {
  if (rest_.empty()) {
    return std::nullopt;
  }
  const std::size_t end = rest_.find('\n');
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  line.remove_suffix(line.ends_with('\r') ? 1 : 0);
  ++number_;
  return line;
}

std::string escaped_xml(std::string_view text) {
  std::string result;
  for (const char character : text) {
    switch (character) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += character;
    }
  }
  return result;
}

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> result;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::string_view word = text.substr(0, text.find_first_of(blanks));
    result.push_back(word);
    text.remove_prefix(word.size());
  }
  return result;
}

std::string listed(std::span<const std::string> items) {
  constexpr std::size_t max_items = 30;
  std::string result;
  for (std::size_t i = 0; i < items.size() && i < max_items; ++i) {
    result += (i == 0 ? "" : ", ") + shortened(items[i]);
  }
  if (items.size() > max_items) {
    result += ", ...";
  }
  return items.empty() ? "nothing" : result;
}

std::optional<std::string> most_similar(std::string_view word, std::span<const std::string> known) {
  std::optional<std::string> best;
  std::size_t least = word.size() / 3 + 1;
  for (const std::string& candidate : known) {
    if (const std::size_t changes = distance_of(word, candidate); changes < least) {
      least = changes;
      best = candidate;
    }
  }
  return best;
}

std::optional<double> parse_number(std::string_view word) {
  double value = 0.0;
  const char* const end = word.data() + word.size();
  const bool has_plus = word.starts_with('+') && !word.starts_with("+-");  // from_chars() takes a minus only
  const auto [rest, error] = std::from_chars(word.data() + (has_plus ? 1 : 0), end, value);
  if (error != std::errc{} || rest != end || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<std::uint32_t> parse_rate(std::string_view text) {
  const bool percent = text.ends_with('%');
  const std::optional<double> number = parse_number(std::string(percent ? text.substr(0, text.size() - 1) : text));
  const double rate = number.value_or(-1.0) / (percent ? 100.0 : 1.0);
  if (!(rate >= 0.0 && rate <= 1.0)) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(std::min(std::round(rate * 4294967296.0), 4294967295.0));
}

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 6);
  return {buffer.data(), error == std::errc{} ? end : buffer.data()};
}

std::string exact_text(double value) {
  if (!std::isfinite(value)) {
    return {};
  }
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string hexadecimal(std::uint32_t value, unsigned min_digits) {
  std::string text;
  for (; value != 0 || text.size() < min_digits; value >>= 4U) {
    text.insert(text.begin(), "0123456789ABCDEF"[value & 15U]);
  }
  return "0x" + text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t tab = line.find('\t');
    cells.push_back(line.substr(0, tab));
    if (tab == std::string_view::npos) {
      return cells;
    }
    line.remove_prefix(tab + 1);
  }
}

}  // namespace proleg
