#include "sim/scenario/tag_scanner.hpp"

#include <algorithm>
#include <vector>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr std::string_view blanks = " \t\r\n";

constexpr std::string_view comment_start = "<!--";
constexpr std::string_view comment_end = "-->";
constexpr std::string_view characters_start = "<![CDATA[";
constexpr std::string_view characters_end = "]]>";

std::string start_tag(std::string_view name) { return "<" + shortened(name) + ">"; }
std::string end_tag(std::string_view name) { return "</" + shortened(name) + ">"; }

}  // namespace

int line_at(std::string_view text, std::size_t position) {
  return 1 + static_cast<int>(std::ranges::count(text.substr(0, position), '\n'));
}

std::size_t line_begin(std::string_view text, std::size_t position) {
  const std::size_t before = text.substr(0, position).rfind('\n');
  return before == std::string_view::npos ? 0 : before + 1;
}

std::optional<TextTag> TagScanner::next() {
  while (true) {
    move_to(std::min(text_.find('<', position_), text_.size()));
    if (position_ == text_.size()) {
      return std::nullopt;
    }
    if (skip("<!--", "-->") || skip("<![CDATA[", "]]>") || skip("<?", "?>") || skip("<!", ">")) {
      continue;
    }
    const bool is_end = text_.substr(position_).starts_with("</");
    const std::size_t name = position_ + (is_end ? 2U : 1U);
    const std::size_t name_end = std::min(text_.find_first_of(" \t\r\n/><", name), text_.size());
    const std::size_t closing = end_of_tag();
    const bool is_empty = !is_end && closing < text_.size() && text_[closing - 1] == '/';
    const TextTag tag{is_end     ? TextTag::Kind::end
                      : is_empty ? TextTag::Kind::empty
                                 : TextTag::Kind::start,
                      text_.substr(name, name_end - name), position_, std::min(closing + 1, text_.size()), line_};
    move_to(tag.end);
    return tag;
  }
}

void TagScanner::move_to(std::size_t position) {
  line_ += static_cast<int>(std::ranges::count(text_.substr(position_, position - position_), '\n'));
  position_ = position;
}

bool TagScanner::skip(std::string_view begin, std::string_view end) {
  if (!text_.substr(position_).starts_with(begin)) {
    return false;
  }
  const std::size_t found = text_.find(end, position_ + begin.size());
  move_to(found == std::string_view::npos ? text_.size() : found + end.size());
  return true;
}

std::size_t TagScanner::end_of_tag() const {
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

std::optional<TextRange> find_attribute(std::string_view text, const TextTag& tag, std::string_view name) {
  const std::string_view whole = text.substr(0, tag.end);
  std::size_t at = tag.begin + 1 + tag.name.size();
  while (true) {
    const std::size_t begin = whole.find_first_not_of(blanks, at);
    const std::size_t equals = whole.find('=', at);
    const std::size_t open = equals == std::string_view::npos ? equals : whole.find_first_of("\"'", equals);
    const std::size_t close = open == std::string_view::npos ? open : whole.find(whole[open], open + 1);
    if (close == std::string_view::npos) {
      return std::nullopt;
    }
    if (lower_case(trimmed(whole.substr(begin, equals - begin))) == lower_case(name)) {
      return TextRange{open + 1, close};
    }
    at = close + 1;
  }
}

std::optional<UnpairedTag> find_unpaired_tag(std::string_view text) {
  TagScanner tags(text);
  std::vector<TextTag> open;
  while (const std::optional<TextTag> tag = tags.next()) {
    if (tag->kind == TextTag::Kind::start) {
      open.push_back(*tag);
    } else if (tag->kind == TextTag::Kind::end) {
      if (open.empty()) {
        return std::nullopt;  // the parser reads no further either
      }
      const TextTag& start = open.back();
      if (start.name != tag->name) {
        return UnpairedTag{start.line,
                           start_tag(start.name) + " without an end tag before " + end_tag(tag->name) + " in line " +
                               std::to_string(tag->line),
                           end_tag(start.name)};
      }
      open.pop_back();
    }
  }
  if (open.empty()) {
    return std::nullopt;
  }
  const TextTag& tag = open.back();
  return UnpairedTag{tag.line, start_tag(tag.name) + " without an end tag", end_tag(tag.name)};
}

std::optional<UnpairedTag> find_unclosed_comment(std::string_view text) {
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    if (text.substr(at).starts_with(comment_start)) {
      const std::size_t end = text.find(comment_end, at + comment_start.size());
      const std::size_t next = text.find(comment_start, at + comment_start.size());
      if (next < end) {
        return UnpairedTag{
            line_at(text, at),
            "a comment without an end before the next one in line " + std::to_string(line_at(text, next)),
            std::string(comment_end)};
      }
      if (end == std::string_view::npos) {
        return UnpairedTag{line_at(text, at), "a comment without an end", std::string(comment_end)};
      }
      at = end + comment_end.size();
    } else if (text.substr(at).starts_with(characters_start)) {
      const std::size_t end = text.find(characters_end, at);
      at = end == std::string_view::npos ? text.size() : end + characters_end.size();
    } else {
      ++at;
    }
  }
  return std::nullopt;
}

}  // namespace proleg::sim
