#pragma once

// An XML file that is edited as text: each edit changes the bytes of its element and no other. Comments, the order of
// tags and attributes, and unknown tags stay.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/scenario/tag_scanner.hpp"

namespace proleg::sim {

/// The text as part of an XML comment, in one line: two hyphens would end it.
[[nodiscard]] std::string comment_text(std::string_view text);

/// A change of a text: at the position the bytes `removed` stand, and `inserted` takes their place.
struct TextPatch {
  std::size_t position = 0;
  std::string removed;
  std::string inserted;
};

/// Applies a patch. The text has `removed` at the position.
void apply(const TextPatch& patch, std::string& text);
/// The patch that takes another one back.
[[nodiscard]] TextPatch inverse(const TextPatch& patch);

/// Position of an element in the order of the start tags; 0 is the outermost one.
using ElementNumber = std::size_t;

class XmlText {
 public:
  struct Element {
    TextTag tag;                          ///< the start tag
    std::size_t end_tag = 0;              ///< where the end tag begins; of an empty element: behind its only tag
    std::size_t end = 0;                  ///< behind the element
    std::optional<ElementNumber> parent;  ///< nothing: it is the outermost one
  };

  /// name: of the file, for messages. Throws InputError for a text whose tags are not paired or that has no tag.
  XmlText(std::string name, std::string text);
  // Elements refer to the text.
  XmlText(const XmlText&) = delete;
  XmlText& operator=(const XmlText&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::size_t size() const { return elements_.size(); }
  [[nodiscard]] const Element& at(ElementNumber element) const { return elements_.at(element); }
  /// Whether the tag has this name, in any case.
  [[nodiscard]] bool is(ElementNumber element, std::string_view tag) const;
  /// The elements directly in another one; with a tag: those with this tag.
  [[nodiscard]] std::vector<ElementNumber> children(ElementNumber element, std::string_view tag = {}) const;
  /// The first one of children().
  [[nodiscard]] std::optional<ElementNumber> child(ElementNumber element, std::string_view tag) const;
  /// The bytes of an element, from its start tag to its end tag.
  [[nodiscard]] std::string_view bytes(ElementNumber element) const;
  /// The value of an attribute, with its references resolved; nothing without the attribute.
  [[nodiscard]] std::optional<std::string> attribute(ElementNumber element, std::string_view attribute) const;

  /// A comment that begins with this word, in any case, after blanks: its range from "<!--" to "-->".
  [[nodiscard]] std::optional<TextRange> comment_with(std::string_view word) const;

  // The patches of edits. None of them is applied.

  /// Replaces the value of an attribute, or adds the attribute.
  [[nodiscard]] TextPatch set_attribute(ElementNumber element, std::string_view attribute,
                                        std::string_view value) const;
  /// Replaces what stands between the tags of an element. Blanks at both ends stay.
  [[nodiscard]] TextPatch set_content(ElementNumber element, std::string_view content) const;
  /// Inserts an element behind another one, with the same indentation. lines: its text, with "\n" and two blanks for
  /// each level. If the other element's line has more than that, the new one follows it in the same line.
  [[nodiscard]] TextPatch add_behind(ElementNumber element, std::string_view lines) const;
  /// Inserts an element as the first child, or as the last one.
  [[nodiscard]] TextPatch add_first(ElementNumber parent, std::string_view lines) const;
  [[nodiscard]] TextPatch add_last(ElementNumber parent, std::string_view lines) const;
  /// Removes an element, and its lines if nothing else stands in them.
  [[nodiscard]] TextPatch remove(ElementNumber element) const;
  /// Replaces a range, for example a comment.
  [[nodiscard]] TextPatch replace(const TextRange& range, std::string_view inserted) const;

 private:
  [[nodiscard]] TextPatch insert(std::size_t position, std::string inserted) const;
  [[nodiscard]] std::string_view line_end() const;
  /// The blanks before an element in its line; nothing if more than blanks is there.
  [[nodiscard]] std::optional<std::string> indentation(ElementNumber element) const;
  [[nodiscard]] std::string child_indentation(ElementNumber parent) const;
  /// The lines with an indentation before each and the line ends of this text; without a line end behind the last one.
  [[nodiscard]] std::string indented(std::string_view lines, std::string_view indentation) const;

  std::string name_;
  std::string text_;
  std::vector<Element> elements_;
};

}  // namespace proleg::sim
