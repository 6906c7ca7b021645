#include "sim/scenario/xml_document.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/tag_scanner.hpp"

namespace proleg::sim {
namespace {

bool same_name(std::string_view left, std::string_view right) { return lower_case(left) == lower_case(right); }

bool contains(std::span<const std::string_view> names, std::string_view name) {
  return std::ranges::any_of(names, [name](std::string_view known) { return same_name(known, name); });
}

std::string listed_tags(std::span<const std::string_view> tags) {
  std::vector<std::string> items;
  for (const std::string_view tag : tags) {
    items.push_back("<" + std::string(tag) + ">");
  }
  return tags.empty() ? "no tags" : listed(items);
}

/// Position of a character reference to the character 0, which XML does not allow and which would end the text early.
std::optional<std::size_t> find_null_reference(std::string_view text) {
  for (std::size_t at = text.find("&#"); at != std::string_view::npos; at = text.find("&#", at + 1)) {
    std::size_t digit = at + 2;
    digit += digit < text.size() && text[digit] == 'x' ? 1U : 0U;
    const std::size_t end = text.find_first_not_of('0', digit);
    if (end != std::string_view::npos && end > digit && text[end] == ';') {
      return at;
    }
  }
  return std::nullopt;
}

std::string_view line_of(std::string_view text, std::size_t at) {
  return trimmed(text.substr(at, text.find('\n', at) - at));
}

/// Position of the line that version control writes before the first of two versions that it could not merge.
std::optional<std::size_t> find_merge_mark(std::string_view text) {
  constexpr std::string_view mark = "\n<<<<<<< ";
  const std::size_t at = text.find(mark);
  return at == std::string_view::npos ? std::nullopt : std::optional(at + 1);
}

/// "mismatched element" for XML_ERROR_MISMATCHED_ELEMENT.
std::string error_words(const tinyxml2::XMLDocument& document) {
  std::string words = lower_case(document.ErrorName());
  std::ranges::replace(words, '_', ' ');
  for (const std::string_view prefix : {"xml ", "error "}) {
    if (words.starts_with(prefix)) {
      words.erase(0, prefix.size());
    }
  }
  return words;
}

class CommentCollector : public tinyxml2::XMLVisitor {
 public:
  bool Visit(const tinyxml2::XMLComment& comment) override {
    comments.push_back({comment.GetLineNum(), comment.Value()});
    return true;
  }
  std::vector<XmlDocument::Comment> comments;
};

}  // namespace

int XmlElement::line() const { return node_->GetLineNum(); }

std::string XmlElement::label() const { return "<" + shortened(node_->Name()) + ">"; }

bool XmlElement::is(std::string_view tag) const { return same_name(node_->Name(), tag); }

void XmlElement::refuse(const std::string& found, const std::string& expected) const {
  throw InputError(document_->name(), line(), found, expected);
}

void XmlElement::check_attributes(std::span<const std::string_view> attributes) const {
  std::vector<std::string_view> seen;
  for (const auto* attribute = node_->FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    const std::string_view name = attribute->Name();
    if (!contains(attributes, name)) {
      std::vector<std::string> known(attributes.begin(), attributes.end());
      refuse("attribute " + in_quotes(name) + " in " + label(),
             known.empty() ? "no attributes" : "one of the attributes " + listed(known));
    }
    if (contains(seen, name)) {
      refuse("attribute " + in_quotes(name) + " twice in " + label(), "it once");
    }
    seen.push_back(name);
  }
}

void XmlElement::allow(std::span<const std::string_view> attributes, std::span<const std::string_view> tags) const {
  check_attributes(attributes);
  for (const auto* node = node_->FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToComment() != nullptr) {
      continue;
    }
    const auto* element = node->ToElement();
    if (element == nullptr) {
      throw InputError(document_->name(), node->GetLineNum(),
                       "text " + in_quotes(trimmed(node->Value())) + " in " + label(), listed_tags(tags));
    }
    if (!contains(tags, element->Name())) {
      const XmlElement unknown(*element, *document_);
      unknown.refuse(unknown.label() + " in " + label(), listed_tags(tags));
    }
  }
}

void XmlElement::allow(std::initializer_list<std::string_view> attributes,
                       std::initializer_list<std::string_view> tags) const {
  allow(std::span(attributes.begin(), attributes.size()), std::span(tags.begin(), tags.size()));
}

std::vector<XmlElement> XmlElement::children() const {
  std::vector<XmlElement> result;
  for (const auto* node = node_->FirstChildElement(); node != nullptr; node = node->NextSiblingElement()) {
    result.emplace_back(*node, *document_);
  }
  return result;
}

std::optional<XmlElement> XmlElement::child(std::string_view tag) const {
  std::optional<XmlElement> result;
  for (const auto* node = node_->FirstChildElement(); node != nullptr; node = node->NextSiblingElement()) {
    const XmlElement element(*node, *document_);
    if (!element.is(tag)) {
      continue;
    }
    if (result) {
      element.refuse("a second " + element.label() + " in " + label(),
                     "one; the first is in line " + std::to_string(result->line()));
    }
    result = element;
  }
  return result;
}

XmlElement XmlElement::required_child(std::string_view tag) const {
  const std::optional<XmlElement> result = child(tag);
  if (!result) {
    refuse("no <" + std::string(tag) + "> in " + label(), "one");
  }
  return *result;
}

std::optional<std::string> XmlElement::attribute(std::string_view name) const {
  for (const auto* attribute = node_->FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    if (same_name(attribute->Name(), name)) {
      return std::string(trimmed(attribute->Value()));
    }
  }
  return std::nullopt;
}

std::string XmlElement::required_attribute(std::string_view name) const {
  std::optional<std::string> result = attribute(name);
  if (!result) {
    refuse("no attribute '" + std::string(name) + "' in " + label(), "one");
  }
  return std::move(*result);
}

std::vector<std::string> XmlElement::attribute_names() const {
  std::vector<std::string> names;
  for (const auto* attribute = node_->FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    names.emplace_back(attribute->Name());
  }
  return names;
}

std::string XmlElement::text(std::initializer_list<std::string_view> attributes) const {
  check_attributes(std::span(attributes.begin(), attributes.size()));
  std::string result;
  for (const auto* node = node_->FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (const auto* text = node->ToText(); text != nullptr) {
      result += text->Value();
    } else if (node->ToComment() == nullptr) {
      throw InputError(document_->name(), node->GetLineNum(), "<" + shortened(node->Value()) + "> in " + label(),
                       "text only");
    }
  }
  return std::string(trimmed(result));
}

std::string name_of(const std::filesystem::path& path) { return path.lexically_normal().string(); }

XmlDocument::XmlDocument(std::filesystem::path path, std::string text, const XmlDocument* includer)
    : path_(std::move(path)),
      name_(name_of(path_)),
      includer_(includer),
      parsed_(std::make_unique<tinyxml2::XMLDocument>()) {
  if (const std::size_t at = text.find('\0'); at != std::string::npos) {
    throw InputError(name_, line_at(text, at), "a byte 0", "XML text");
  }
  if (const auto at = find_null_reference(text)) {
    throw InputError(name_, line_at(text, *at), "a reference to the character 0", "XML text");
  }
  if (const auto at = find_invalid_utf8(text)) {
    throw InputError(name_, line_at(text, *at), "bytes that are not UTF-8", "XML text in UTF-8");
  }
  if (const auto comment = find_unclosed_comment(text)) {
    throw InputError(name_, comment->line, comment->found, comment->expected);
  }
  if (parsed_->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    if (const auto mark = find_merge_mark(text)) {
      throw InputError(name_, line_at(text, *mark), "the mark of a merge conflict, " + in_quotes(line_of(text, *mark)),
                       "one of the two versions, without the lines '<<<<<<<', '=======' and '>>>>>>>'");
    }
    const tinyxml2::XMLError error = parsed_->ErrorID();
    const bool may_lack_tag = error == tinyxml2::XML_ERROR_PARSING || error == tinyxml2::XML_ERROR_MISMATCHED_ELEMENT;
    if (const auto unpaired = may_lack_tag ? find_unpaired_tag(text) : std::nullopt) {
      throw InputError(name_, unpaired->line, unpaired->found, unpaired->expected);
    }
    throw InputError(name_, std::max(parsed_->ErrorLineNum(), 1), "malformed XML (" + error_words(*parsed_) + ")",
                     "well-formed XML");
  }
  for (const auto* node = parsed_->FirstChild(); node != nullptr; node = node->NextSibling()) {
    const bool second_root = node->ToElement() != nullptr && node != parsed_->RootElement();
    if (second_root || node->ToText() != nullptr || node->ToUnknown() != nullptr) {
      throw InputError(name_, node->GetLineNum(), in_quotes(trimmed(node->Value())) + " beside the outermost tag",
                       "one outermost tag and comments");
    }
  }
}

XmlDocument::~XmlDocument() = default;

XmlElement XmlDocument::root(std::string_view tag) const { return root(std::span(&tag, 1)); }

XmlElement XmlDocument::root(std::span<const std::string_view> tags) const {
  if (parsed_->RootElement() == nullptr) {
    throw InputError(name_, 1, "no tag", listed_tags(tags));
  }
  const XmlElement root(*parsed_->RootElement(), *this);
  if (!contains(tags, parsed_->RootElement()->Name())) {
    root.refuse(root.label() + " as the outermost tag", listed_tags(tags));
  }
  return root;
}

std::vector<XmlDocument::Comment> XmlDocument::comments() const {
  CommentCollector collector;
  parsed_->Accept(&collector);
  return std::move(collector.comments);
}

}  // namespace proleg::sim
