#include "sim/mesh/mesh_text.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/mesh/mesh_checks.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t stl_header_size = 80;
constexpr std::size_t stl_count_size = 4;
constexpr std::size_t stl_triangle_size = 50;

/// Has the mark of UTF-16 or UTF-32, or starts with two characters of ASCII in UTF-16.
bool is_wide_text(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    return true;
  }
  const auto is_zero = [&](std::size_t place) { return bytes[place] == '\0'; };
  return bytes.size() >= 4 && is_zero(0) == is_zero(2) && is_zero(1) == is_zero(3) && is_zero(0) != is_zero(1);
}

bool is_text(std::string_view bytes) {
  return std::ranges::all_of(bytes, [](char c) { return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r'); });
}

std::size_t stl_count(std::string_view bytes) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < stl_count_size; ++i) {
    count |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[stl_header_size + i])) << (8 * i);
  }
  return count;
}

/// The file without its rest. A rest that could be another triangle shows that the number of triangles is wrong.
std::string without_rest(const std::string& name, const std::string& bytes) {
  const std::size_t count = bytes.size() < stl_header_size + stl_count_size ? 0 : stl_count(bytes);
  const std::size_t size = stl_header_size + stl_count_size + stl_triangle_size * count;
  const bool is_whole = count > 0 && bytes.size() >= size;
  const std::string_view rest = std::string_view(bytes).substr(is_whole ? size : 0);
  if (!is_whole || (rest.size() >= stl_triangle_size && !is_text(rest) && rest.find_first_not_of('\0') != rest.npos)) {
    throw MeshError("a binary STL file of " + std::to_string(bytes.size()) + " bytes that says it has " +
                        std::to_string(count) + " triangles, " + in_quotes(name),
                    "at least one triangle, and " + std::to_string(stl_header_size + stl_count_size) + " bytes and " +
                        std::to_string(stl_triangle_size) + " for each");
  }
  return bytes.substr(0, size);
}

/// Reads the words of an STL text one after the other.
class StlText {
 public:
  StlText(const std::string& name, std::string_view text) : name_(name), text_(text), words_(words(text)) {}

  std::string solids() {
    std::string result;
    read_solid(result);
    while (is_at("solid") || is_at_facet()) {
      read_solid(result);
    }
    for (; next_ < words_.size(); ++next_) {
      if (is_at("facet") || is_at("vertex")) {
        refuse("'solid'");
      }
    }
    return result;
  }

 private:
  [[nodiscard]] bool is_at(std::string_view word) const { return next_ < words_.size() && words_[next_] == word; }

  [[nodiscard]] bool is_at_facet() const {
    return is_at("facet") && next_ + 2 < words_.size() && words_[next_ + 1] == "normal" && is_number(words_[next_ + 2]);
  }

  /// Some programs write a decimal comma, which Assimp reads as well. A normal may be "-nan(ind)".
  static bool is_number(std::string_view word) {
    return is_finite(word) || word.find("nan") != word.npos || word.find("inf") != word.npos;
  }
  static bool is_finite(std::string_view word) {
    std::string number(word);
    std::ranges::replace(number, ',', '.');
    return parse_number(number).has_value();
  }

  [[noreturn]] void refuse(const std::string& expected) const {
    const bool is_at_end = next_ == words_.size();
    const std::size_t place = is_at_end ? text_.size() : static_cast<std::size_t>(words_[next_].data() - text_.data());
    const auto line = std::ranges::count(text_.substr(0, place), '\n') + 1;
    throw MeshError((is_at_end ? "the end of the file" : in_quotes(one_line(words_[next_]))) + " in line " +
                        std::to_string(line) + " of " + in_quotes(name_),
                    expected);
  }

  void take(std::string_view word) {
    if (!is_at(word)) {
      refuse(in_quotes(word));
    }
    ++next_;
  }

  /// The name of a solid is the rest of the line. Files of a single line have a facet or the end of the solid there.
  void skip_name() {
    const auto is_in_line = [&] {
      const std::string_view before = words_[next_ - 1];
      const char* const end = before.data() + before.size();
      return std::string_view(end, static_cast<std::size_t>(words_[next_].data() - end)).find('\n') ==
             std::string_view::npos;
    };
    while (next_ < words_.size() && is_in_line() && !is_at_facet() && !is_at("endsolid")) {
      ++next_;
    }
  }

  /// Three numbers, with a line end behind them. `instead`: of numbers that are not finite.
  std::string numbers(const char* instead) {
    std::string result;
    bool all_finite = true;
    for (int i = 0; i < 3; ++i, ++next_) {
      all_finite = all_finite && next_ < words_.size() && is_finite(words_[next_]);
      if (next_ == words_.size() || !(all_finite || (instead != nullptr && is_number(words_[next_])))) {
        refuse("a number");
      }
      result += ' ' + std::string(words_[next_]);
    }
    return (all_finite ? result : instead) + '\n';
  }

  void read_solid(std::string& result) {
    if (!is_at_facet() || next_ == 0) {  // the second solid of a line may be here
      take("solid");
    }
    skip_name();
    std::string facets;
    while (is_at("facet")) {
      ++next_;
      take("normal");
      facets += "facet normal" + numbers(" 0 0 0");
      take("outer");
      take("loop");
      facets += "outer loop\n";
      for (int corner = 0; corner < 3; ++corner) {
        take("vertex");
        facets += "vertex" + numbers(nullptr);
      }
      take("endloop");
      take("endfacet");
      facets += "endloop\nendfacet\n";
    }
    if (!is_at("endsolid")) {
      refuse("'facet' or 'endsolid'");
    }
    ++next_;
    skip_name();
    if (!facets.empty()) {
      result += "solid\n" + facets + "endsolid\n";
    }
  }

  const std::string& name_;
  std::string_view text_;
  std::vector<std::string_view> words_;
  std::size_t next_ = 0;
};

}  // namespace

std::string plain_text(const std::string& name, const std::string& bytes) {
  if (is_wide_text(bytes)) {
    throw MeshError("text in UTF-16, " + in_quotes(name), "text in UTF-8 or ASCII; editors can save it so");
  }
  std::string text(without_byte_order_mark(bytes));
  for (std::size_t i = text.find('\r'); i != std::string::npos; i = text.find('\r', i + 1)) {
    if (i + 1 == text.size() || text[i + 1] != '\n') {
      text[i] = '\n';
    }
  }
  return text;
}

std::string plain_stl(const std::string& name, const std::string& bytes) {
  // A text of at most 16 MiB is too short for the number that its characters would be.
  const bool is_binary = bytes.size() >= stl_header_size + stl_count_size &&
                         stl_count(bytes) <= (bytes.size() - stl_header_size - stl_count_size) / stl_triangle_size;
  if (is_binary || (bytes.find('\0') != std::string::npos && !is_wide_text(bytes))) {
    return without_rest(name, bytes);
  }
  const std::string text = lower_case(plain_text(name, bytes));
  std::string solids = StlText(name, text).solids();
  if (solids.empty()) {
    throw MeshError("no triangle in " + in_quotes(name), "a mesh of triangles");
  }
  return solids;
}

}  // namespace proleg::sim
