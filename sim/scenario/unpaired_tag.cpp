#include "sim/scenario/unpaired_tag.hpp"

#include <algorithm>
#include <vector>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

struct OpenTag {
  std::string_view name;
  int line;
};

constexpr std::string_view comment_start = "<!--";
constexpr std::string_view comment_end = "-->";

std::string start_tag(std::string_view name) { return "<" + shortened(name) + ">"; }
std::string end_tag(std::string_view name) { return "</" + shortened(name) + ">"; }

/// Reads a text from tag to tag.
class TagScanner {
 public:
  explicit TagScanner(std::string_view text) : text_(text) {}

  std::optional<UnpairedTag> find_unclosed_comment() {
    while (skip_to_tag()) {
      if (text_.substr(position_).starts_with(comment_start)) {
        const int line = line_;
        const std::size_t end = text_.find(comment_end, position_ + comment_start.size());
        const std::size_t next = text_.find(comment_start, position_ + comment_start.size());
        if (next < end) {
          move_to(next);
          return UnpairedTag{line, "a comment without an end before the next one in line " + std::to_string(line_),
                             std::string(comment_end)};
        }
        if (end == std::string_view::npos) {
          return UnpairedTag{line, "a comment without an end", std::string(comment_end)};
        }
        move_to(end + comment_end.size());
      } else if (!skip("<![CDATA[", "]]>")) {
        move_to(position_ + 1);
      }
    }
    return std::nullopt;
  }

  std::optional<UnpairedTag> find_unpaired_tag() {
    while (skip_to_tag()) {
      if (skip(comment_start, comment_end) || skip("<![CDATA[", "]]>") || skip("<?", "?>") || skip("<!", ">")) {
        continue;
      }
      if (text_.substr(position_).starts_with("</")) {
        if (std::optional<UnpairedTag> unpaired = close()) {
          return unpaired;
        }
      } else {
        open();
      }
    }
    if (open_.empty()) {
      return std::nullopt;
    }
    const OpenTag& tag = open_.back();
    return UnpairedTag{tag.line, start_tag(tag.name) + " without an end tag", end_tag(tag.name)};
  }

 private:
  /// False at the end of the text.
  bool skip_to_tag() {
    move_to(std::min(text_.find('<', position_), text_.size()));
    return position_ < text_.size();
  }

  void move_to(std::size_t position) {
    line_ += static_cast<int>(std::ranges::count(text_.substr(position_, position - position_), '\n'));
    position_ = position;
  }

  /// Skips what begins and ends like this, if it is here.
  bool skip(std::string_view begin, std::string_view end) {
    if (!text_.substr(position_).starts_with(begin)) {
      return false;
    }
    const std::size_t found = text_.find(end, position_ + begin.size());
    move_to(found == std::string_view::npos ? text_.size() : found + end.size());
    return true;
  }

  [[nodiscard]] std::string_view name_at(std::size_t position) const {
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n/><", position), text_.size());
    return text_.substr(position, end - position);
  }

  /// Position of the '>' of a tag; a '>' in quotes is part of an attribute.
  [[nodiscard]] std::size_t end_of_tag() const {
    char quote = '\0';
    for (std::size_t i = position_; i < text_.size(); ++i) {
      if (quote != '\0') {
        quote = text_[i] == quote ? '\0' : quote;
      } else if (text_[i] == '"' || text_[i] == '\'') {
        quote = text_[i];
      } else if (text_[i] == '>') {
        return i;
      }
    }
    return text_.size();
  }

  void open() {
    const OpenTag tag{name_at(position_ + 1), line_};
    const std::size_t end = end_of_tag();
    if (end == text_.size() || text_[end - 1] != '/') {
      open_.push_back(tag);
    }
    move_to(std::min(end + 1, text_.size()));
  }

  std::optional<UnpairedTag> close() {
    const std::string_view name = name_at(position_ + 2);
    if (open_.empty()) {
      move_to(text_.size());  // the parser reads no further either
      return std::nullopt;
    }
    const OpenTag tag = open_.back();
    if (tag.name != name) {
      return UnpairedTag{
          tag.line,
          start_tag(tag.name) + " without an end tag before " + end_tag(name) + " in line " + std::to_string(line_),
          end_tag(tag.name)};
    }
    open_.pop_back();
    move_to(std::min(end_of_tag() + 1, text_.size()));
    return std::nullopt;
  }

  std::string_view text_;
  std::size_t position_ = 0;
  int line_ = 1;
  std::vector<OpenTag> open_;
};

}  // namespace

std::optional<UnpairedTag> find_unpaired_tag(std::string_view text) { return TagScanner(text).find_unpaired_tag(); }

std::optional<UnpairedTag> find_unclosed_comment(std::string_view text) {
  return TagScanner(text).find_unclosed_comment();
}

}  // namespace proleg::sim
