#include "sim/scenario/unpaired_tag.hpp"

#include <algorithm>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/tag_scanner.hpp"

namespace proleg::sim {
namespace {

constexpr std::string_view comment_start = "<!--";
constexpr std::string_view comment_end = "-->";
constexpr std::string_view characters_start = "<![CDATA[";
constexpr std::string_view characters_end = "]]>";

std::string start_tag(std::string_view name) { return "<" + shortened(name) + ">"; }
std::string end_tag(std::string_view name) { return "</" + shortened(name) + ">"; }

}  // namespace

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
