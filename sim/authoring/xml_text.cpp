#include "sim/authoring/xml_text.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr std::string_view blanks = " \t";
constexpr std::string_view indentation_step = "  ";

bool is_blank(std::string_view text) { return text.find_first_not_of(blanks) == std::string_view::npos; }

/// The value of an attribute as a parser reads it.
std::string unescaped(std::string_view value, char quote) {
  tinyxml2::XMLDocument document;
  const std::string text = "<a v=" + (quote + std::string(value)) + quote + "/>";
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return std::string(value);
  }
  return document.RootElement()->Attribute("v");
}

}  // namespace

std::string comment_text(std::string_view text) {
  std::string line = one_line(text);
  for (std::size_t at = line.find("--"); at != std::string::npos; at = line.find("--", at)) {
    line.replace(at, 2, "- -");
  }
  return line;
}

void apply(const TextPatch& patch, std::string& text) {
  text.replace(patch.position, patch.removed.size(), patch.inserted);
}

TextPatch inverse(const TextPatch& patch) { return {patch.position, patch.inserted, patch.removed}; }

XmlText::XmlText(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)) {
  const auto refuse = [this](const UnpairedTag& tag) { throw InputError(name_, tag.line, tag.found, tag.expected); };
  if (const auto comment = find_unclosed_comment(text_)) {
    refuse(*comment);
  }
  std::vector<ElementNumber> open;
  TagScanner tags(text_);
  while (const std::optional<TextTag> tag = tags.next()) {
    if (tag->kind == TextTag::Kind::end) {
      if (open.empty()) {
        refuse({tag->line, "</" + shortened(tag->name) + "> without a start tag", "pairs of tags"});
      }
      if (elements_[open.back()].tag.name != tag->name) {
        refuse(find_unpaired_tag(text_).value());
      }
      Element& element = elements_[open.back()];
      element.end_tag = tag->begin;
      element.end = tag->end;
      open.pop_back();
      continue;
    }
    elements_.push_back({*tag, tag->end, tag->end, open.empty() ? std::nullopt : std::optional(open.back())});
    if (tag->kind == TextTag::Kind::start) {
      open.push_back(elements_.size() - 1);
    }
  }
  if (!open.empty()) {
    refuse(find_unpaired_tag(text_).value());
  }
  if (elements_.empty()) {
    throw InputError(name_, 1, "no tag", "XML");
  }
}

bool XmlText::is(ElementNumber element, std::string_view tag) const {
  return lower_case(at(element).tag.name) == lower_case(tag);
}

std::vector<ElementNumber> XmlText::children(ElementNumber element, std::string_view tag) const {
  std::vector<ElementNumber> result;
  for (ElementNumber i = element + 1; i < elements_.size() && elements_[i].tag.begin < at(element).end; ++i) {
    if (elements_[i].parent == element && (tag.empty() || is(i, tag))) {
      result.push_back(i);
    }
  }
  return result;
}

std::optional<ElementNumber> XmlText::child(ElementNumber element, std::string_view tag) const {
  const std::vector<ElementNumber> all = children(element, tag);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

std::string_view XmlText::bytes(ElementNumber element) const {
  const Element& found = at(element);
  return std::string_view(text_).substr(found.tag.begin, found.end - found.tag.begin);
}

std::optional<std::string> XmlText::attribute(ElementNumber element, std::string_view attribute) const {
  const std::optional<TextRange> range = find_attribute(text_, at(element).tag, attribute);
  if (!range) {
    return std::nullopt;
  }
  return unescaped(std::string_view(text_).substr(range->begin, range->end - range->begin), text_[range->end]);
}

std::optional<TextRange> XmlText::comment_with(std::string_view word) const {
  constexpr std::string_view start = "<!--";
  constexpr std::string_view end = "-->";
  const std::string_view text = text_;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at + 1)) {
    if (text.substr(at).starts_with("<![CDATA[")) {
      at = std::min(text.find("]]>", at), text.size() - 1);
    } else if (text.substr(at).starts_with(start)) {
      const std::size_t close = text.find(end, at);  // the constructor has checked that there is one
      if (lower_case(trimmed(text.substr(at + start.size(), close - at - start.size())))
              .starts_with(lower_case(word))) {
        return TextRange{at, close + end.size()};
      }
      at = close;
    }
  }
  return std::nullopt;
}

TextPatch XmlText::set_attribute(ElementNumber element, std::string_view attribute, std::string_view value) const {
  const TextTag& tag = at(element).tag;
  if (const auto range = find_attribute(text_, tag, attribute)) {
    std::string text = escaped_xml(value);
    if (text_[range->end] == '\'') {
      std::string quoted;
      for (const char character : text) {
        quoted += character == '\'' ? "&apos;" : std::string(1, character);
      }
      text = std::move(quoted);
    }
    return replace(*range, text);
  }
  // Behind the last attribute, or behind the name.
  const std::size_t closing = tag.end - (tag.kind == TextTag::Kind::empty ? 2 : 1);
  const std::size_t last = text_.find_last_not_of(" \t\r\n", closing - 1) + 1;
  return insert(last, " " + std::string(attribute) + "=\"" + escaped_xml(value) + '"');
}

TextPatch XmlText::set_content(ElementNumber element, std::string_view content) const {
  const Element& found = at(element);
  const TextTag& tag = found.tag;
  if (tag.kind == TextTag::Kind::empty) {
    const std::size_t slash = tag.end - 2;
    const std::size_t begin = text_.find_last_not_of(" \t\r\n", slash - 1) + 1;
    return replace({begin, tag.end}, ">" + escaped_xml(content) + "</" + std::string(tag.name) + ">");
  }
  const std::string_view inner = std::string_view(text_).substr(tag.end, found.end_tag - tag.end);
  const std::string_view kept = trimmed(inner);
  const std::size_t begin = kept.empty() ? tag.end : tag.end + static_cast<std::size_t>(kept.data() - inner.data());
  return replace({begin, kept.empty() ? found.end_tag : begin + kept.size()}, escaped_xml(content));
}

TextPatch XmlText::add_behind(ElementNumber element, std::string_view lines) const {
  const std::size_t end = at(element).end;
  const std::size_t line = std::min(text_.find('\n', end), text_.size());
  const std::optional<std::string> indentation_of_line = indentation(element);
  const std::string_view rest = trimmed(std::string_view(text_).substr(end, line - end));
  const bool ends_line = rest.empty() || (rest.starts_with("<!--") && rest.find("-->") == rest.size() - 3);
  if (!indentation_of_line || !ends_line) {
    return insert(end, indented(lines, ""));
  }
  const std::size_t line_text_end = line > end && text_[line - 1] == '\r' ? line - 1 : line;
  return insert(line_text_end, std::string(line_end()) + indented(lines, *indentation_of_line));
}

TextPatch XmlText::add_first(ElementNumber parent, std::string_view lines) const {
  const Element& found = at(parent);
  const std::string inner = child_indentation(parent);
  const std::string text = std::string(line_end()) + indented(lines, inner);
  if (found.tag.kind != TextTag::Kind::empty) {
    const std::size_t line = std::min(text_.find('\n', found.tag.end), text_.size());
    const bool ends_line = is_blank(trimmed(std::string_view(text_).substr(found.tag.end, line - found.tag.end)));
    return insert(found.tag.end, ends_line ? text : text + std::string(line_end()) + inner);
  }
  return add_last(parent, lines);
}

TextPatch XmlText::add_last(ElementNumber parent, std::string_view lines) const {
  const Element& found = at(parent);
  const std::string inner = child_indentation(parent);
  const std::string outer = indentation(parent).value_or("");
  const std::string text = indented(lines, inner);
  if (found.tag.kind == TextTag::Kind::empty) {
    const std::size_t begin = text_.find_last_not_of(" \t\r\n", found.tag.end - 3) + 1;
    return replace({begin, found.tag.end}, ">" + std::string(line_end()) + text + std::string(line_end()) + outer +
                                               "</" + std::string(found.tag.name) + ">");
  }
  // Before the line of the end tag, if that stands alone in it.
  const std::size_t line = line_begin(text_, found.end_tag);
  if (line >= found.tag.end && is_blank(std::string_view(text_).substr(line, found.end_tag - line))) {
    return insert(line, text + std::string(line_end()));
  }
  return insert(found.end_tag, std::string(line_end()) + text + std::string(line_end()) + outer);
}

TextPatch XmlText::remove(ElementNumber element) const {
  const Element& found = at(element);
  const std::size_t line = line_begin(text_, found.tag.begin);
  const std::size_t next = text_.find('\n', found.end);
  const std::size_t line_text_end = std::min(next, text_.size());
  const bool is_alone = is_blank(std::string_view(text_).substr(line, found.tag.begin - line)) &&
                        trimmed(std::string_view(text_).substr(found.end, line_text_end - found.end)).empty();
  if (!is_alone) {
    return replace({found.tag.begin, found.end}, "");
  }
  return replace({line, next == std::string::npos ? text_.size() : next + 1}, "");
}

TextPatch XmlText::replace(const TextRange& range, std::string_view inserted) const {
  return {range.begin, text_.substr(range.begin, range.end - range.begin), std::string(inserted)};
}

TextPatch XmlText::insert(std::size_t position, std::string inserted) const {
  return {position, {}, std::move(inserted)};
}

std::string_view XmlText::line_end() const {
  const std::size_t first = text_.find('\n');
  return first != std::string::npos && first > 0 && text_[first - 1] == '\r' ? "\r\n" : "\n";
}

std::optional<std::string> XmlText::indentation(ElementNumber element) const {
  const std::size_t begin = at(element).tag.begin;
  const std::size_t line = line_begin(text_, begin);
  const std::string indentation = text_.substr(line, begin - line);
  return is_blank(indentation) ? std::optional(indentation) : std::nullopt;
}

std::string XmlText::child_indentation(ElementNumber parent) const {
  for (const ElementNumber child : children(parent)) {
    if (const auto found = indentation(child)) {
      return *found;
    }
  }
  return indentation(parent).value_or("") + std::string(indentation_step);
}

std::string XmlText::indented(std::string_view lines, std::string_view indentation) const {
  std::string result;
  TextLines all(lines);
  while (const std::optional<std::string_view> line = all.next()) {
    if (!result.empty()) {
      result += line_end();
    }
    result += std::string(indentation) + std::string(*line);
  }
  return result;
}

}  // namespace proleg::sim
