#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace proleg::sim {

/// The line of a position in a text, from 1.
[[nodiscard]] int line_at(std::string_view text, std::size_t position);

/// Where the line of a position begins.
[[nodiscard]] std::size_t line_begin(std::string_view text, std::size_t position);

/// A tag as it stands in the text of an XML file.
struct TextTag {
  enum class Kind : std::uint8_t { start, end, empty };
  Kind kind;
  std::string_view name;
  std::size_t begin;  ///< position of its '<'
  std::size_t end;    ///< position behind its '>', or the end of the text
  int line;           ///< of its '<'
};

/// Finds the tags of a text, which need not be valid XML. Comments and the like are no tags.
class TagScanner {
 public:
  /// text: must outlive the scanner and its tags.
  explicit TagScanner(std::string_view text) : text_(text) {}

  [[nodiscard]] std::optional<TextTag> next();

 private:
  void move_to(std::size_t position);
  /// Skips what begins and ends like this, if it is here.
  bool skip(std::string_view begin, std::string_view end);
  /// Position of the '>' of a tag; a '>' in quotes is part of an attribute.
  [[nodiscard]] std::size_t end_of_tag() const;

  std::string_view text_;
  std::size_t position_ = 0;
  int line_ = 1;
};

/// Where the value of an attribute stands in the text, between its quotes. The case of the name does not matter.
struct TextRange {
  std::size_t begin;
  std::size_t end;
};
[[nodiscard]] std::optional<TextRange> find_attribute(std::string_view text, const TextTag& tag, std::string_view name);

/// A start tag without its end tag, or a comment without its end.
struct UnpairedTag {
  int line = 0;
  std::string found;     ///< for a message: "<Joint> without an end tag before </KinBody> in line 50"
  std::string expected;  ///< "</Joint>"
};

/// The first one of a text; nothing if every start tag has its end tag.
[[nodiscard]] std::optional<UnpairedTag> find_unpaired_tag(std::string_view text);

/// The first comment of a text that does not end, or that has another "<!--" before its end. XML allows neither, and a
/// parser would take what follows for comment, up to the end of the next one.
[[nodiscard]] std::optional<UnpairedTag> find_unclosed_comment(std::string_view text);

}  // namespace proleg::sim
